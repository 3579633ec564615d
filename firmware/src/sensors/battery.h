// The battery's voltage, and the alarm when it is low.
#pragma once
#include <stdint.h>

namespace mucat {

// mV from the converter's counts (0 to 1023 for 5 V) behind a divider of two equal resistors, times `factor`
// in ten-thousandths.
uint16_t battery_millivolts(uint16_t counts, uint16_t factor);

// Alarm after 20 s below a voltage, or where it is below for more than a sixth of the time: dips of strokes
// add up where a worn pack has many, and what is past is forgotten within two minutes. It stays until the
// next reset, because a flat battery recovers without load.
class BatteryAlarm {
 public:
  // True once, when the alarm begins.
  bool update(uint16_t millivolts, uint16_t alarm_millivolts, uint32_t now_ms);
  bool on() const { return on_; }

 private:
  bool on_ = false;
  uint16_t low_ms_ = 0;
  uint16_t updated_ms_ = 0;
};

}  // namespace mucat
