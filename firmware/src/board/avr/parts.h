// The start functions that board::start() calls, in this order.
#pragma once
#include <stdint.h>

namespace mucat {
namespace board {

void start_pins();
void start_clock();
void start_line();
void start_i2c();
void start_spi();

// Ticks since the watchdog was fed, from before the reset until start() has found its cause.
extern volatile uint8_t unfed_ticks;
// Its complement: where a brown-out damaged one of both, neither counts.
extern volatile uint8_t unfed_complement;

}  // namespace board
}  // namespace mucat
