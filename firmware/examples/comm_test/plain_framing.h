// Numbers as two bytes, the high one first, and nothing else. The request is the byte 0xff, which no number
// of this framing (0 to 254) contains. After an odd number of lost bytes every later number is wrong.
#pragma once

#include <Arduino.h>

#include "counts.h"

class PlainFraming {
 public:
  Event take(uint8_t byte, Counts &counts) {
    if (byte == REQUEST_BYTE) {
      counts.framing_errors += half_;
      half_ = false;
      return REQUEST;
    }
    counts.bytes_read++;
    half_ = !half_;
    if (half_) {
      high_ = byte;
      return NOTHING;
    }
    counts.count((uint16_t)(high_ << 8 | byte));
    return MESSAGE;
  }

  static void send(uint16_t number) {
    Serial.write((uint8_t)(number >> 8));
    Serial.write((uint8_t)number);
  }

 private:
  static constexpr uint8_t REQUEST_BYTE = 0xff;

  uint8_t high_ = 0;
  bool half_ = false;
};
