#include "link/debug.h"

#include <stddef.h>

namespace mucat {

static_assert(DebugQueue::kBytes >= 4 * sizeof(Debug), "too small for the lines of a start");

uint8_t debug_bytes(const Debug& line) { return offsetof(Debug, text) + line.text_size; }

DebugLine::DebugLine(DebugLevel level) {
  packet_.time = 0;
  packet_.level = static_cast<uint8_t>(level);
  packet_.text_size = 0;
}

void DebugLine::put(char character) {
  if (packet_.text_size < Debug::kTextMax) packet_.text[packet_.text_size++] = character;
}

DebugLine& DebugLine::operator<<(FlashText text) {
  for (const char* at = text.at; const char character = pgm_read_byte(at); ++at) put(character);
  return *this;
}

DebugLine& DebugLine::operator<<(uint16_t number) {
  uint8_t count = 1;
  for (uint16_t rest = number / 10; rest; rest /= 10) ++count;
  return digits(number, count);
}

DebugLine& DebugLine::digits(uint16_t number, uint8_t digits) {
  uint16_t divisor = 1;
  for (uint8_t i = 1; i < digits; ++i) divisor *= 10;
  for (; divisor; divisor /= 10) put('0' + number / divisor % 10);
  return *this;
}

uint8_t DebugQueue::at(uint8_t offset) const {
  const uint16_t index = head_ + offset;
  return bytes_[index < kBytes ? index : index - kBytes];
}

void DebugQueue::push(const Debug& line) {
  const uint8_t size = debug_bytes(line);
  if (size > kBytes - used_) {
    ++lost_;
    return;
  }
  const uint8_t* const from = reinterpret_cast<const uint8_t*>(&line);
  for (uint8_t i = 0; i < size; ++i) {
    const uint16_t index = head_ + used_;
    bytes_[index < kBytes ? index : index - kBytes] = from[i];
    ++used_;
  }
}

bool DebugQueue::peek(uint8_t offset, Debug* line) const {
  if (offset >= used_) return false;
  uint8_t* const to = reinterpret_cast<uint8_t*>(line);
  const uint8_t size = offsetof(Debug, text) + at(offset + offsetof(Debug, text_size));
  for (uint8_t i = 0; i < size; ++i) to[i] = at(offset + i);
  return true;
}

void DebugQueue::drop(uint8_t bytes) {
  const uint16_t head = head_ + bytes;
  head_ = head < kBytes ? head : head - kBytes;
  used_ -= bytes;
}

}  // namespace mucat
