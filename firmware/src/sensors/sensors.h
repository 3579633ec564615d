// All sensors but the fins' encoders, read once a tick.
#pragma once
#include <stdint.h>

#include "packets.gen.h"
#include "sensors/attitude.h"
#include "sensors/battery.h"
#include "sensors/depth.h"
#include "sensors/mpu6050.h"
#include "sensors/ms5837.h"

namespace mucat {

class Sensors {
 public:
  // The calibration is used from now on, as it is then.
  void start(const Calibration& calibration) {
    calibration_ = &calibration;
    attitude_.start();
    surface_.start();
  }
  // Call every tick; `ticks` have passed since the last call. The surface is measured only while disarmed.
  void step(uint8_t ticks, bool armed);

  // Takes the newest reading; false if there is no new one. The water's density is in kg/m³.
  bool take(Imu* packet);
  bool take(Depth* packet, uint16_t density);
  void read(Beacon* packet) const;
  bool surface_uncertain() const { return surface_.uncertain(); }
  // The surface is measured anew.
  void zero_depth() { surface_.forget(); }

  uint16_t battery_millivolts() const { return battery_millivolts_; }
  uint8_t imu_identity() const { return imu_.identity(); }
  // Bits of DeviceFault.
  uint16_t faults() const;

 private:
  void read_imu(uint8_t ticks);
  void read_pressure(bool armed);
  void read_battery();

  const Calibration* calibration_ = nullptr;
  Mpu6050 imu_;
  Attitude attitude_;
  ImuReading imu_reading_ = {};
  uint32_t imu_time_ = 0;
  bool imu_fresh_ = false;

  Ms5837 pressure_;
  Surface surface_;
  PressureReading pressure_reading_ = {};
  uint16_t pressure_stepped_us_ = 0;
  uint32_t pressure_time_ = 0;
  bool depth_fresh_ = false;

  uint16_t battery_millivolts_ = 0;
  uint8_t battery_tick_ = 0;
};

}  // namespace mucat
