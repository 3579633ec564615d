// DRV8830 H-bridge on I2C (data sheet: serial interface, CONTROL and FAULT registers).
#pragma once
#include <stdint.h>

namespace mucat {

// Sets the drive of a fin's motor, -63 to 63; 0 lets it coast. Magnitudes below 6 are below the chip's range
// and coast too. False if the chip did not answer.
bool drive_bridge(uint8_t fin, int8_t drive);

// True if the chip is silent or reports a fault (overcurrent, overheating, undervoltage). Clears a reported
// fault, so that the motor can run again.
bool bridge_failed(uint8_t fin);

}  // namespace mucat
