// The robot's own sketch: everything happens in the library.
#include <mucat.h>

mucat::Robot robot;

void setup() { robot.start(); }

void loop() { robot.step(); }
