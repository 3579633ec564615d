// Consistent Overhead Byte Stuffing (Cheshire and Baker, 1999) for blocks below 254 bytes: one byte longer,
// and free of zeros.
#pragma once
#include <stdint.h>

namespace mucat {

constexpr uint8_t kCobsOverhead = 1;

// `out` takes size + 1 bytes; returns that many. `size` is at most 253.
uint8_t encode_cobs(const uint8_t* bytes, uint8_t size, uint8_t* out);

// Decodes in place; returns the size, or 0 where the block is empty or malformed.
uint8_t decode_cobs(uint8_t* bytes, uint8_t size);

}  // namespace mucat
