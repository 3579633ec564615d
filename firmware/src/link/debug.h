// Lines of text for people: built without printf, queued without ever waiting.
#pragma once
#include <stdint.h>

#include "board/flash.h"
#include "packets.gen.h"

namespace mucat {

// A line in the making; what does not fit is cut.
class DebugLine {
 public:
  explicit DebugLine(DebugLevel level);
  DebugLine& operator<<(FlashText text);
  DebugLine& operator<<(uint16_t number);
  // `digits` decimal digits, with leading zeros.
  DebugLine& digits(uint16_t number, uint8_t digits);
  Debug& packet() { return packet_; }

 private:
  void put(char character);

  Debug packet_;
};

// Lines that are not acknowledged yet. A full queue drops the new line and counts it.
class DebugQueue {
 public:
  static constexpr uint8_t kBytes = 224;

  void push(const Debug& line);
  // The line that starts so many bytes behind the oldest, copied; false where there is none. It stays until
  // drop().
  bool peek(uint8_t offset, Debug* line) const;
  // Forgets the oldest bytes, which are whole lines.
  void drop(uint8_t bytes);
  uint16_t lost() const { return lost_; }

 private:
  uint8_t at(uint8_t offset) const;

  uint8_t bytes_[kBytes];
  uint8_t head_ = 0;
  uint8_t used_ = 0;
  uint16_t lost_ = 0;
};

// Payload bytes of a line on the wire.
uint8_t debug_bytes(const Debug& line);

}  // namespace mucat
