// The chip's end of the line with the Arduino core's Serial, whose ring holds 63 bytes, as any sketch has it.
// `Framing` makes messages of bytes.
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

  // Whether the host has said anything.
  bool heard() const { return heard_; }

  // One message, or what there is of it.
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

  void tell(const Counts &counts) { send_result(counts); }

  // Until a byte comes, and without sleeping through one that has come since the caller looked.
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

  // A moment of a delay. Every interrupt, the clock's millisecond too, ends it.
  void wait() { sleep_mode(); }

 private:
  static constexpr int RING_BYTES = SERIAL_RX_BUFFER_SIZE - 1;

  Framing framing_;
  bool heard_ = false;
};
