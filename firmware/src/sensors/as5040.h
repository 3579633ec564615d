// AS5040 magnetic rotary encoder, 10 bits a turn, on SPI (data sheet: synchronous serial interface).
#pragma once
#include <stdint.h>

namespace mucat {

// The field of the encoder's magnet, in the data sheet's colours.
enum class MagneticField : uint8_t {
  kUnusable,  // red, or the chip did not answer
  kYellow,    // too weak or too strong: the angle is less exact
  kGreen,
};

// Reads the chip's word, after its leading 1: D9 to D0, five status bits, even parity over all sixteen.
uint16_t read_encoder_word(uint8_t fin);

// Reads the fin's position, 0 to 1023; `counts` is unchanged if it is unusable.
MagneticField read_encoder_counts(uint8_t fin, int16_t* counts);

}  // namespace mucat
