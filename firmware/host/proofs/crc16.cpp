// Replaces the CRC-32 in tests that must see corruptions pass: CRC-16/CCITT, with the upper half 0.
#include "link/crc32.h"

namespace mucat {

uint32_t crc32(const uint8_t* bytes, uint8_t size) {
  uint16_t crc = 0xFFFF;
  while (size--) {
    crc ^= static_cast<uint16_t>(*bytes++ << 8);
    for (uint8_t bit = 0; bit < 8; ++bit) {
      crc = static_cast<uint16_t>(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

}  // namespace mucat
