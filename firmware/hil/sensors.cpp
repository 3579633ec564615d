// IMU and pressure sensor as the simulator tells of them, in place of their drivers.
#include "loop.h"
#include "sensors/mpu6050.h"
#include "sensors/ms5837.h"

namespace mucat {
namespace {

loop::Listener imu_listener;
loop::Listener pressure_listener;

}  // namespace

// Between two words it shows the last one again, as the filter behind it counts on a reading every tick.
bool Mpu6050::step(ImuReading* reading) {
  imu_listener.step();
  faulty_ = imu_listener.lost();
  if (faulty_) return false;
  for (uint8_t axis = 0; axis < 3; ++axis) {
    reading->rate[axis] = loop::sense().rate[axis];
    reading->force[axis] = loop::sense().force[axis];
  }
  return true;
}

bool Ms5837::step(PressureReading* reading) {
  const bool fresh = pressure_listener.step();
  faulty_ = pressure_listener.lost();
  if (!fresh) return false;
  reading->pressure = loop::sense().pressure;
  reading->temperature = loop::sense().temperature;
  return true;
}

}  // namespace mucat
