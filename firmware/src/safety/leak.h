// The leak sensor: two bare ends of wire at the lowest place in the hull. Water between them pulls the pin
// low.
#pragma once
#include <stdint.h>

namespace mucat {

class LeakAlarm {
 public:
  // Call every tick. True once, when the sensor has been wet for 200 ms without a break: motors disturb a
  // long wire for less. The alarm lasts until the next start.
  bool update(bool wet) {
    if (on_) return false;
    wet_ticks_ = wet ? wet_ticks_ + 1 : 0;
    on_ = wet_ticks_ >= kTicks;
    return on_;
  }
  bool on() const { return on_; }

 private:
  static constexpr uint8_t kTicks = 20;

  uint8_t wet_ticks_ = 0;
  bool on_ = false;
};

}  // namespace mucat
