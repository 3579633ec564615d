// MPU-6050 gyroscope and accelerometer on I2C (register map RM-MPU-6000A).
#pragma once
#include <stdint.h>

namespace mucat {

constexpr float kRadiansPerSecondPerCount = 0.00026632423f;  // 65.5 counts per °/s
constexpr float kGPerCount = 1.0f / 8192.0f;

// One reading in raw counts; axes forward, right, down, as the chip is mounted.
struct ImuReading {
  int16_t rate[3];
  int16_t force[3];
};

class Mpu6050 {
 public:
  // Call every tick: sets the chip up when it (re)appears and reads it. True if `reading` is new.
  bool step(ImuReading* reading);
  bool faulty() const { return faulty_; }

 private:
  bool set_up();

  bool ready_ = false;
  bool faulty_ = false;
  uint8_t wait_ = 0;
};

}  // namespace mucat
