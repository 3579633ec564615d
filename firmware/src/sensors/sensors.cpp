#include "sensors/sensors.h"

#include <math.h>

#include "board/board.h"
#include "fins/fin_law.h"

namespace mucat {
namespace {

constexpr float kUnitCounts = 16384.0f;
constexpr uint8_t kBatteryTicks = 10;

// The chip's reading along one of its axes, as the calibration numbers them: -3 to 3 without 0.
int32_t along(int8_t axis, const int16_t (&chip)[3]) {
  // cppcheck-suppress negativeIndex
  return axis < 0 ? -static_cast<int32_t>(chip[-axis - 1]) : chip[axis - 1];
}

int16_t limited(int32_t value) {
  return value > INT16_MAX ? INT16_MAX : value < INT16_MIN ? INT16_MIN : value;
}

}  // namespace

void Sensors::step(uint8_t ticks, bool armed) {
  read_imu(ticks);
  read_pressure(armed);
  read_battery();
}

void Sensors::read_imu(uint8_t ticks) {
  const uint32_t now = board::microseconds();
  ImuReading chip;
  if (!imu_.step(&chip)) return;
  imu_time_ = now;
  imu_fresh_ = true;
  float rate[3];
  float force[3];
  for (uint8_t axis = 0; axis < 3; ++axis) {
    const int8_t from = calibration_->axes[axis];
    imu_reading_.rate[axis] = limited(along(from, chip.rate) - calibration_->gyro_bias[axis]);
    imu_reading_.force[axis] = limited(along(from, chip.force));
    rate[axis] = imu_reading_.rate[axis] * kRadiansPerSecondPerCount;
    force[axis] = imu_reading_.force[axis] * kGPerCount;
  }
  attitude_.update(rate, force, ticks * kTickSeconds);
}

void Sensors::read_pressure(bool armed) {
  const uint32_t now = board::microseconds();
  // The tick after a long one comes early.
  const bool due = static_cast<uint16_t>(now - pressure_stepped_us_) >= kPressureStepUs;
  if (due) pressure_stepped_us_ = now;
  if (due && pressure_.step(&pressure_reading_)) {
    pressure_time_ = now;
    if (!armed) surface_.add(pressure_reading_.pressure);
    depth_fresh_ = surface_.known();
  }
  surface_.step(pressure_reading_.pressure, armed);
}

// The converter runs from one tick to the next, ten times a second.
void Sensors::read_battery() {
  if (battery_tick_ == 0) board::start_battery();
  if (battery_tick_ == 1) {
    battery_millivolts_ = mucat::battery_millivolts(board::take_battery(), calibration_->battery_factor);
  }
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

bool Sensors::take(Depth* packet, uint16_t density) {
  if (!depth_fresh_) return false;
  depth_fresh_ = false;
  packet->time = pressure_time_;
  packet->depth = surface_.depth(pressure_reading_.pressure, density);
  packet->pressure = pressure_reading_.pressure - calibration_->pressure_offset;
  packet->temperature = pressure_reading_.temperature;
  return true;
}

void Sensors::read(Beacon* packet) const {
  packet->time = board::microseconds();
  packet->right = board::beacon_right() != calibration_->beacons_inverted;
  packet->left = board::beacon_left() != calibration_->beacons_inverted;
}

uint16_t Sensors::faults() const {
  return (imu_.faulty() ? static_cast<uint16_t>(DeviceFault::kImu) : 0) |
         (pressure_.faulty() ? static_cast<uint16_t>(DeviceFault::kPressure) : 0) |
         (surface_.uncertain() ? static_cast<uint16_t>(DeviceFault::kSurface) : 0);
}

}  // namespace mucat
