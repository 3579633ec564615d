#include "sensors/battery.h"

namespace mucat {
namespace {

constexpr uint32_t kFullScaleMillivolts = 2 * 5000UL;
constexpr uint16_t kCountsMax = 1023;
constexpr uint16_t kFactorUnit = 10000;

// Below this no battery is connected to the divider: the chip itself would not run on it.
constexpr uint16_t kConnectedMillivolts = 3000;
constexpr uint32_t kAlarmMs = 20000;

}  // namespace

uint16_t battery_millivolts(uint16_t counts, uint16_t factor) {
  const uint32_t nominal = (counts * kFullScaleMillivolts + kCountsMax / 2) / kCountsMax;
  return (nominal * factor + kFactorUnit / 2) / kFactorUnit;
}

bool BatteryAlarm::update(uint16_t millivolts, uint16_t alarm_millivolts, uint32_t now_ms) {
  const bool low = millivolts < alarm_millivolts && millivolts >= kConnectedMillivolts;
  if (low && !low_) since_ms_ = now_ms;
  low_ = low;
  if (on_ || !low || now_ms - since_ms_ < kAlarmMs) return false;
  on_ = true;
  return true;
}

}  // namespace mucat
