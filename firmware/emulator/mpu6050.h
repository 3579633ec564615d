// SPDX-License-Identifier: GPL-3.0-or-later
// InvenSense MPU-6050: turn rate and specific force, on I2C. Its axes are the body's.
#ifndef MPU6050_H
#define MPU6050_H

#include <stdint.h>

#include "surroundings.h"

#define MPU6050_REGISTERS 128

struct mpu6050 {
  const struct surroundings *surroundings;
  uint8_t registers[MPU6050_REGISTERS];
  uint8_t pointer;
  enum fault fault;
};

void mpu6050_create(struct mpu6050 *imu, const struct surroundings *surroundings);
// A dip of the supply: the chip sleeps with its settings lost.
void mpu6050_dip(struct mpu6050 *imu);

bool mpu6050_start(void *imu);
void mpu6050_write(void *imu, unsigned index, uint8_t byte);
uint8_t mpu6050_read(void *imu);

#endif
