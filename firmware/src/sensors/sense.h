// A simulator's word on what the sensors would show. The robot has sensors of its own and passes it over; the
// firmware for hardware in the loop (firmware/hil) has nothing else.
#pragma once
#include "packets.gen.h"

namespace mucat {

void feel(const Sense& sense);
// Whether this is the firmware for hardware in the loop.
bool in_the_loop();

}  // namespace mucat
