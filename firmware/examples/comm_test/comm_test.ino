// The communication test: numbers over the serial line, with a delay after each, and counts of what arrived.
// Each framing brings its own end of the line. See docs/reference/comm-test.md.
#include "counts.h"
#include "parameters.h"

#if COMM_TEST_FRAMING == COMM_TEST_PLAIN
#include "plain_framing.h"
#include "serial_end.h"
using End = SerialEnd<PlainFraming>;
#elif COMM_TEST_FRAMING == COMM_TEST_THESIS
#include "serial_end.h"
#include "thesis_framing.h"
using End = SerialEnd<ThesisFraming>;
#elif COMM_TEST_FRAMING == COMM_TEST_ROBOT
#include "robot_end.h"
using End = RobotEnd;
#else
#error "COMM_TEST_FRAMING names no framing of this sketch"
#endif

constexpr unsigned long DELAY_MS = (unsigned long)(COMM_TEST_ARDUINO_DELAY * 1000 + 0.5);

End end_of_line;
Counts counts;
uint16_t next_number = COMM_TEST_FROM;

// Weak in the core, which calls it within delay(). The chip idles while it waits.
void yield() { end_of_line.wait(); }

bool receive() {
  Event event = end_of_line.receive(counts);
  if (event == REQUEST) {
    end_of_line.send_result(counts);
  }
  return event == MESSAGE;
}

bool send() {
  if (!(COMM_TEST_DIRECTION & COMM_TEST_TO_HOST) || !end_of_line.heard() || next_number == COMM_TEST_TO) {
    return false;
  }
  end_of_line.send(next_number++);
  return true;
}

void setup() { end_of_line.start(); }

void loop() {
  bool received = receive();
  bool sent = send();
  if (received || sent) {
    delay(DELAY_MS);
  } else {
    end_of_line.rest();
  }
}
