#include "link/debug.h"

#include <stddef.h>

namespace mucat {

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

DebugLine& DebugLine::hex(uint8_t number) {
  for (uint8_t shift = 8; shift;) {
    shift -= 4;
    const uint8_t digit = number >> shift & 15;
    put(digit < 10 ? '0' + digit : 'A' - 10 + digit);
  }
  return *this;
}

DebugLine& DebugLine::digits(uint16_t number, uint8_t digits) {
  uint16_t divisor = 1;
  for (uint8_t i = 1; i < digits; ++i) divisor *= 10;
  for (; divisor; divisor /= 10) put('0' + number / divisor % 10);
  return *this;
}

}  // namespace mucat
