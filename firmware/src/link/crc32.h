// CRC-32 as zlib computes it (IEEE 802.3, reflected).
#pragma once
#include <stdint.h>

namespace mucat {

uint32_t crc32(const uint8_t* bytes, uint8_t size);

}  // namespace mucat
