// AS5040 magnetic rotary encoder, 10 bits a turn, on SPI (data sheet: synchronous serial interface).
#pragma once
#include <stdint.h>

namespace mucat {

// Reads the fin's position, 0 to 1023. False, with `counts` unchanged, if the chip did not answer or reports
// that its magnet is out of place.
bool read_encoder_counts(uint8_t fin, int16_t* counts);

}  // namespace mucat
