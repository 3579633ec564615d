// The chip's end of the line with the Arduino core's Serial, whose ring holds 63 bytes. `Framing` makes
// messages of bytes.
#pragma once

#include <Arduino.h>
#include <avr/sleep.h>

#include "counts.h"
#include "thesis_packet.h"

template <typename Framing>
class SerialEnd {
 public:
  void start() {
    set_sleep_mode(SLEEP_MODE_IDLE);
    Serial.begin(COMM_TEST_BAUD);
  }

  // True if the host has sent a byte.
  bool heard() const { return heard_; }

  // Reads one message, or the part of it that has come.
  Event receive(Counts &counts) {
    counts.ring_full += Serial.available() == RING_BYTES;
    while (Serial.available()) {
      heard_ = true;
      Event event = framing_.take((uint8_t)Serial.read(), counts);
      if (event != NOTHING) {
        return event;
      }
    }
    return NOTHING;
  }

  void send(uint16_t number) { Framing::send(number); }

  void send_result(const Counts &counts) { ::send_result(counts); }

  // Sleeps until a byte comes; one that came since the caller checked counts too.
  void rest() {
    noInterrupts();
    if (!Serial.available()) {
      sleep_enable();
      interrupts();
      sleep_cpu();
      sleep_disable();
    }
    interrupts();
  }

  // Sleeps until the next interrupt, at most a millisecond.
  void wait() { sleep_mode(); }

 private:
  static constexpr int RING_BYTES = SERIAL_RX_BUFFER_SIZE - 1;

  Framing framing_;
  bool heard_ = false;
};
