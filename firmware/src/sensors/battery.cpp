#include "sensors/battery.h"

namespace mucat {
namespace {

constexpr uint32_t kFullScaleMillivolts = 2 * 5000UL;
constexpr uint16_t kCountsMax = 1023;
constexpr uint16_t kFactorUnit = 10000;

// Below this no battery is connected to the divider: the chip itself would not run on it.
constexpr uint16_t kConnectedMillivolts = 3000;
// Each 1024 ms this share of the time below the voltage is forgotten: what is low for a share of the time
// comes to 110.6 s of it. A sound pack dips for less than a sixth of a stroke, and stays under the alarm.
constexpr uint8_t kForgotten = 108;
// Reached after 20 s without a break.
constexpr uint16_t kAlarmMs = 18350;

}  // namespace

uint16_t battery_millivolts(uint16_t counts, uint16_t factor) {
  const uint32_t nominal = (counts * kFullScaleMillivolts + kCountsMax / 2) / kCountsMax;
  return (nominal * factor + kFactorUnit / 2) / kFactorUnit;
}

bool BatteryAlarm::update(uint16_t millivolts, uint16_t alarm_millivolts, uint32_t now_ms) {
  const bool low = millivolts < alarm_millivolts && millivolts >= kConnectedMillivolts;
  const uint16_t now = now_ms;
  const uint16_t elapsed = now - updated_ms_;
  const bool forgets = (now ^ updated_ms_) >> 10;
  updated_ms_ = now;
  if (on_) return false;
  if (low) low_ms_ += elapsed;
  if (forgets) low_ms_ -= low_ms_ / kForgotten;
  if (low_ms_ < kAlarmMs) return false;
  on_ = true;
  return true;
}

}  // namespace mucat
