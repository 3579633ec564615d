#include "sensors/sense.h"

namespace mucat {

void feel(const Sense&) {}

bool in_the_loop() { return false; }

}  // namespace mucat
