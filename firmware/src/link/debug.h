// Lines of text for people, built without printf.
#pragma once
#include <stdint.h>

#include "board/flash.h"
#include "packets.gen.h"

namespace mucat {

// Builds one line; text that does not fit is cut off.
class DebugLine {
 public:
  explicit DebugLine(DebugLevel level);
  DebugLine& operator<<(FlashText text);
  DebugLine& operator<<(uint16_t number);
  DebugLine& hex(uint8_t number);
  // `digits` decimal digits, with leading zeros.
  DebugLine& digits(uint16_t number, uint8_t digits);
  Debug& packet() { return packet_; }

 private:
  void put(char character);

  Debug packet_;
};

// Bytes of the line's payload on the wire.
uint8_t debug_bytes(const Debug& line);

}  // namespace mucat
