#include "link/crc32.h"

#include "board/flash.h"

namespace mucat {
namespace {

// One entry a nibble: 64 bytes of flash and two look-ups a byte, where one a byte would take a kilobyte.
const uint32_t kTable[16] PROGMEM = {
    0x00000000UL, 0x1db71064UL, 0x3b6e20c8UL, 0x26d930acUL, 0x76dc4190UL, 0x6b6b51f4UL,
    0x4db26158UL, 0x5005713cUL, 0xedb88320UL, 0xf00f9344UL, 0xd6d6a3e8UL, 0xcb61b38cUL,
    0x9b64c2b0UL, 0x86d3d2d4UL, 0xa00ae278UL, 0xbdbdf21cUL,
};

}  // namespace

uint32_t crc32(const uint8_t* bytes, uint8_t size) {
  uint32_t crc = 0xFFFFFFFFUL;
  while (size--) {
    crc ^= *bytes++;
    crc = (crc >> 4) ^ pgm_read_dword(&kTable[crc & 15]);
    crc = (crc >> 4) ^ pgm_read_dword(&kTable[crc & 15]);
  }
  return ~crc;
}

}  // namespace mucat
