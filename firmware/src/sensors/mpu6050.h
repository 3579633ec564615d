// MPU-6050 gyroscope and accelerometer on I2C (register map RM-MPU-6000A).
#pragma once
#include <stdint.h>

namespace mucat {

constexpr float kRadiansPerSecondPerCount = 0.00026632423f;  // 65.5 counts per °/s
constexpr float kGPerCount = 1.0f / 8192.0f;
constexpr uint8_t kMpu6050 = 0x68;

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
  // What it answered to WHO_AM_I; 0 if nothing.
  uint8_t identity() const { return identity_; }

 private:
  bool set_up();
  bool check();

  uint8_t unchecked_ = 0;  // ticks
  bool ready_ = false;
  bool faulty_ = false;
  uint8_t wait_ = 0;
  uint8_t identity_ = 0;
};

}  // namespace mucat
