// AS5040 magnetic rotary encoder, 10 bits a turn, on SPI (data sheet: synchronous serial interface).
#pragma once
#include <stdint.h>

namespace mucat {

// The fin's position, 0 to 1023. False, and `counts` left alone, where the chip did not answer or says that
// its magnet is out of place.
bool read_encoder_counts(uint8_t fin, int16_t* counts);

}  // namespace mucat
