// The bring-up: shows what every part says, as it says it, and turns one motor at a time while the host wants
// it. It never arms. See docs/run/bring-up.md.
#include "bench.h"

Bench bench;

void setup() { bench.start(); }

void loop() { bench.step(); }
