// Sensor readings from a simulator. The robot has sensors of its own and ignores them; the firmware for
// hardware in the loop (firmware/hil) has no others.
#pragma once
#include "packets.gen.h"

namespace mucat {

void accept_simulated_input(const Sense& sense);
// True in the firmware for hardware in the loop.
bool in_the_loop();

}  // namespace mucat
