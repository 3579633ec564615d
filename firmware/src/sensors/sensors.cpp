#include "sensors/sensors.h"

#include <math.h>

#include "board/board.h"
#include "fins/fin_law.h"

namespace mucat {
namespace {

constexpr float kUnitCounts = 16384.0f;
constexpr uint8_t kBatteryTicks = 10;

}  // namespace

void Sensors::step(uint8_t ticks, bool at_surface) {
  read_imu(ticks);
  read_pressure(at_surface);
  read_battery();
}

void Sensors::read_imu(uint8_t ticks) {
  const uint32_t now = board::microseconds();
  if (!imu_.step(&imu_reading_)) return;
  imu_time_ = now;
  imu_fresh_ = true;
  float rate[3];
  float force[3];
  for (uint8_t axis = 0; axis < 3; ++axis) {
    rate[axis] = imu_reading_.rate[axis] * kRadiansPerSecondPerCount;
    force[axis] = imu_reading_.force[axis] * kGPerCount;
  }
  attitude_.update(rate, force, ticks * kTickSeconds);
}

void Sensors::read_pressure(bool at_surface) {
  const uint32_t now = board::microseconds();
  if (!pressure_.step(&pressure_reading_)) return;
  pressure_time_ = now;
  if (at_surface) surface_.add(pressure_reading_.pressure);
  depth_fresh_ = surface_.known();
}

// The converter runs from one tick to the next, ten times a second.
void Sensors::read_battery() {
  if (battery_tick_ == 0) board::start_battery();
  if (battery_tick_ == 1) battery_millivolts_ = mucat::battery_millivolts(board::take_battery());
  battery_tick_ = (battery_tick_ + 1) % kBatteryTicks;
}

bool Sensors::take(Imu* packet) {
  if (!imu_fresh_) return false;
  imu_fresh_ = false;
  packet->time = imu_time_;
  for (uint8_t i = 0; i < 4; ++i) packet->attitude[i] = lroundf(attitude_.quaternion()[i] * kUnitCounts);
  for (uint8_t axis = 0; axis < 3; ++axis) {
    packet->rate[axis] = imu_reading_.rate[axis];
    packet->force[axis] = imu_reading_.force[axis];
  }
  return true;
}

bool Sensors::take(Depth* packet) {
  if (!depth_fresh_) return false;
  depth_fresh_ = false;
  packet->time = pressure_time_;
  packet->depth = surface_.depth(pressure_reading_.pressure);
  packet->pressure = pressure_reading_.pressure;
  packet->temperature = pressure_reading_.temperature;
  return true;
}

void Sensors::read(Beacon* packet) const {
  packet->time = board::microseconds();
  packet->right = board::beacon_right();
  packet->left = board::beacon_left();
}

uint8_t Sensors::faults() const {
  return (imu_.faulty() ? static_cast<uint8_t>(DeviceFault::kImu) : 0) |
         (pressure_.faulty() ? static_cast<uint8_t>(DeviceFault::kPressure) : 0);
}

}  // namespace mucat
