// The robot's sketch; the library does everything.
#include <mucat.h>

mucat::Robot robot;

void setup() { robot.start(); }

void loop() { robot.step(); }
