// The communication test: numbers over the serial line, with a delay after each, and counts of what arrived.
// It uses the Arduino core's Serial, whose ring holds 63 bytes, as any sketch does. See
// docs/communication.md.
#include <avr/sleep.h>

#include "counts.h"
#include "parameters.h"

#if COMM_TEST_FRAMING == COMM_TEST_PLAIN
#include "plain_framing.h"
using Framing = PlainFraming;
#elif COMM_TEST_FRAMING == COMM_TEST_THESIS
#include "thesis_framing.h"
using Framing = ThesisFraming;
#else
#error "COMM_TEST_FRAMING names no framing of this sketch"
#endif

constexpr unsigned long DELAY_MS = (unsigned long)(COMM_TEST_ARDUINO_DELAY * 1000 + 0.5);
constexpr int RING_BYTES = SERIAL_RX_BUFFER_SIZE - 1;

Framing framing;
Counts counts;
uint16_t next_number = COMM_TEST_FROM;
bool started = false;

// The chip idles while it waits; every interrupt, the clock's millisecond too, goes on with it. Weak in the
// core, which calls it within delay().
void yield() { sleep_mode(); }

// Without sleeping through a byte that has come since the caller looked.
void wait_for_byte() {
  noInterrupts();
  if (!Serial.available()) {
    sleep_enable();
    interrupts();
    sleep_cpu();
    sleep_disable();
  }
  interrupts();
}

// One message, or what there is of it; whether it was a whole one.
bool receive() {
  counts.ring_full += Serial.available() == RING_BYTES;
  while (Serial.available()) {
    started = true;
    Framing::Event event = framing.take((uint8_t)Serial.read(), counts);
    if (event == Framing::REQUEST) {
      tell(counts);
    }
    if (event != Framing::NOTHING) {
      return event == Framing::MESSAGE;
    }
  }
  return false;
}

bool send() {
  if (!(COMM_TEST_DIRECTION & COMM_TEST_TO_HOST) || !started || next_number == COMM_TEST_TO) {
    return false;
  }
  Framing::send(next_number++);
  return true;
}

void setup() {
  set_sleep_mode(SLEEP_MODE_IDLE);
  Serial.begin(COMM_TEST_BAUD);
}

void loop() {
  bool received = receive();
  bool sent = send();
  if (received || sent) {
    delay(DELAY_MS);
  } else {
    wait_for_byte();
  }
}
