// The LED: on while armed, a blink a second while disarmed, five a second at a fault.
#pragma once
#include <stdint.h>

namespace mucat {

// True if the LED is lit in this tick; `tick_of_second` counts the ticks of 10 ms.
inline bool led_lit(bool armed, bool fault, uint8_t tick_of_second) {
  if (fault) return tick_of_second % 20 < 10;
  return armed || tick_of_second < 10;
}

}  // namespace mucat
