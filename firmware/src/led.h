// The LED: on while armed, a blink a second while disarmed, five a second at a fault. Armed, it also counts
// down: two blinks a second, and one long one for each of the last three seconds.
#pragma once
#include <stdint.h>

namespace mucat {

class Led {
 public:
  // Shows the time until the end, in tenths of a second, until kTicks are over. The host repeats it.
  void count_down(uint8_t remaining) {
    remaining_ = remaining;
    ticks_ = kTicks;
  }

  // Call every tick. True if the LED is lit in it; `tick_of_second` counts the ticks of 10 ms.
  bool lit(bool armed, bool fault, uint8_t tick_of_second) {
    if (ticks_) --ticks_;
    if (fault) return tick_of_second % 20 < 10;
    if (!armed) return tick_of_second < 10;
    if (!ticks_) return true;
    return remaining_ > kLast ? remaining_ % 5 >= 3 : (remaining_ + 9) % 10 >= 3;
  }

 private:
  static constexpr uint8_t kTicks = 30;
  static constexpr uint8_t kLast = 30;

  uint8_t remaining_ = 0;
  uint8_t ticks_ = 0;
};

}  // namespace mucat
