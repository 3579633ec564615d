// SPDX-License-Identifier: GPL-3.0-or-later
// InvenSense MPU-6050: turn rate and specific force, on I2C. It measures at its own rate. The simulated water
// has the filter of 44 Hz; a narrower one that CONFIG sets comes on top.
#ifndef MPU6050_H
#define MPU6050_H

#include <stdint.h>

#include "device_clock.h"
#include "surroundings.h"
#include "wiring.h"

#define MPU6050_REGISTERS 128

struct mpu6050 {
  struct device_clock clock;
  const struct surroundings *surroundings;
  const struct wiring *wiring;
  double woken;              // s, end of its sleep
  double sample;             // number since then; -1: none
  double filtered;           // s, the filter's time
  double force[3], rate[3];  // behind it, in body axes
  uint8_t registers[MPU6050_REGISTERS];
  uint8_t pointer;
  enum fault fault;
};

void mpu6050_create(struct mpu6050 *imu, struct device_clock clock, const struct surroundings *surroundings,
                    const struct wiring *wiring);
// A dip of the supply: the chip is as after power-on, with its settings lost.
void mpu6050_dip(struct mpu6050 *imu);
// Call it before the surroundings change.
void mpu6050_filter(struct mpu6050 *imu);

bool mpu6050_start(void *imu);
void mpu6050_write(void *imu, unsigned index, uint8_t byte);
uint8_t mpu6050_read(void *imu);

#endif
