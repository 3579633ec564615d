// Replaces the CRC-32 in tests that must see corruptions pass: the thesis's checksum, an exclusive or.
#include "link/crc32.h"

namespace mucat {

uint32_t crc32(const uint8_t* bytes, uint8_t size) {
  uint8_t sum = 0;
  while (size--) sum ^= *bytes++;
  return sum;
}

}  // namespace mucat
