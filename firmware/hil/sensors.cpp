// IMU and pressure sensor with the simulator's values, in place of their drivers.
#include "loop.h"
#include "sensors/mpu6050.h"
#include "sensors/ms5837.h"

namespace mucat {
namespace {

loop::Listener imu_listener;
loop::Listener pressure_listener;

}  // namespace

// Between two readings it repeats the last one, as the filter behind it needs a reading every tick.
bool Mpu6050::step(ImuReading* reading) {
  imu_listener.step();
  faulty_ = imu_listener.lost();
  if (faulty_) return false;
  for (uint8_t axis = 0; axis < 3; ++axis) {
    reading->rate[axis] = loop::newest_input().rate[axis];
    reading->force[axis] = loop::newest_input().force[axis];
  }
  return true;
}

bool Ms5837::step(PressureReading* reading) {
  const bool fresh = pressure_listener.step();
  faulty_ = pressure_listener.lost();
  if (!fresh) return false;
  reading->pressure = loop::newest_input().pressure;
  reading->temperature = loop::newest_input().temperature;
  return true;
}

}  // namespace mucat
