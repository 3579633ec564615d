#include "sensors/simulated_input.h"

namespace mucat {

void accept_simulated_input(const Sense&) {}

bool in_the_loop() { return false; }

}  // namespace mucat
