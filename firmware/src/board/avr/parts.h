// The start functions that board::start() calls, in this order.
#pragma once

namespace mucat {
namespace board {

void start_pins();
void start_clock();
void start_line();
void start_i2c();
void start_spi();

}  // namespace board
}  // namespace mucat
