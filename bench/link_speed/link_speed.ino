// Both ends say lines of text as fast as the link takes them. The board says lines as long as those that it
// hears, and tells in a Status, where a heartbeat asks it, how many have come and how many of them were not
// the next. A line's level counts.
#include <mucat.h>

#include "board/avr/parts.h"
#include "board/board.h"
#include "link/link.h"

namespace {

mucat::Link the_link;
mucat::Debug heard;
mucat::Status report;
uint8_t expected;
uint8_t said;
bool talking;
bool full;

void take(const mucat::Message &message) {
  memcpy(&heard, message.payload, message.size);
  if (heard.level != expected) {
    report.missed_ticks++;
  }
  expected = heard.level + 1;
  report.time++;
  talking = true;
}

void tell() {
  report.frames_invalid = the_link.frames_invalid();
  report.bytes_lost = mucat::board::bytes_lost();
  the_link.send(report);
  the_link.flush();
}

void handle(const mucat::Message &message) {
  switch (message.type) {
    case mucat::Hello::kType:
      the_link.answer(mucat::unpack<mucat::Hello>(message), report.epoch);
      break;
    case mucat::Debug::kType:
      take(message);
      break;
    case mucat::Heartbeat::kType:
      tell();
      break;
    default:
      break;
  }
}

void say() {
  mucat::DebugLine line(static_cast<mucat::DebugLevel>(said));
  line.packet().text_size = heard.text_size;
  memcpy(line.packet().text, heard.text, heard.text_size);
  const uint16_t lost = the_link.lines_lost();
  the_link.queue_line(line);
  full = the_link.lines_lost() != lost;
  if (!full) {
    said++;
  }
}

}  // namespace

void setup() {
  mucat::board::start_line();
  report.epoch = mucat::board::next_epoch();
  the_link.greet(report.epoch);
}

void loop() {
  mucat::board::feed_watchdog();
  if (the_link.receive()) {
    full = false;
    for (mucat::Message message; the_link.next(&message);) {
      handle(message);
    }
  }
  while (talking && !full) {
    say();
  }
  the_link.step(mucat::board::milliseconds());
}
