// The robot's sketch with a fault: two seconds after it was armed, the main loop hangs. After the watchdog's
// reset the board is disarmed, so that it hangs again only if it is armed again.
#include <mucat.h>

mucat::Robot robot;
unsigned long disarmed_ms;

void setup() { robot.start(); }

void loop() {
  robot.step();
  if (!robot.armed()) disarmed_ms = millis();
  while (millis() - disarmed_ms > 2000) {
  }
}
