// DRV8830 H-bridge on I2C (data sheet: serial interface, CONTROL and FAULT registers).
#pragma once
#include <stdint.h>

namespace mucat {

// Drive -63 to 63 of a fin's motor; 0 lets it coast. Magnitudes below 6 are below what the chip can give, and
// coast as well. False where the chip did not answer.
bool drive_bridge(uint8_t fin, int8_t drive);

// Whether the chip is silent or reports a fault (too much current, too hot, too little voltage). A reported
// fault is cleared, so that the motor gets another try.
bool bridge_failed(uint8_t fin);

}  // namespace mucat
