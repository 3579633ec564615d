// Consistent Overhead Byte Stuffing (Cheshire and Baker, 1999) for blocks below 254 bytes: the result has one
// byte more and no zeros.
#pragma once
#include <stdint.h>

namespace mucat {

constexpr uint8_t kCobsOverhead = 1;

// Writes size + 1 bytes to `out` and returns that size. `size` is at most 253.
uint8_t encode_cobs(const uint8_t* bytes, uint8_t size, uint8_t* out);

// Decodes in place; returns the size, or 0 if the block is empty or malformed. A zero ends a block.
uint8_t decode_cobs(uint8_t* bytes, uint8_t size);

}  // namespace mucat
