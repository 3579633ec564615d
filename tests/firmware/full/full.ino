// The robot's sketch with a fault: two seconds after it was armed, it has used all but 40 bytes of the memory
// that is left to the stack. Until the next reset the board reports it.
#include <mucat.h>

extern uint8_t _end;

mucat::Robot robot;
unsigned long disarmed_ms;

void setup() { robot.start(); }

void loop() {
  robot.step();
  if (!robot.armed()) disarmed_ms = millis();
  if (millis() - disarmed_ms > 2000) (&_end)[40] = 0;
}
