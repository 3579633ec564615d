// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices.h"

#include <stddef.h>
#include <string.h>

#define IMU_ADDRESS 0x69
#define PRESSURE_ADDRESS 0x76
static const uint8_t bridge_addresses[FIN_COUNT] = {0x64, 0x60, 0x61, 0x63};

void devices_create(struct devices *devices, struct device_clock clock) {
  *devices = (struct devices){.surroundings = STILL_WATER};
  mpu6050_create(&devices->imu, &devices->surroundings);
  ms5837_create(&devices->pressure, clock, &devices->surroundings);
  motors_create(&devices->motors, devices->bridges, devices->encoders, &devices->surroundings);
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    devices->bridges[i].powered = &devices->motor_power;
    devices->i2c[i] = (struct i2c_device){bridge_addresses[i], &devices->bridges[i], drv8830_start,
                                          drv8830_write, drv8830_read};
  }
  devices->i2c[FIN_COUNT] =
      (struct i2c_device){IMU_ADDRESS, &devices->imu, mpu6050_start, mpu6050_write, mpu6050_read};
  devices->i2c[FIN_COUNT + 1] =
      (struct i2c_device){PRESSURE_ADDRESS, &devices->pressure, ms5837_start, ms5837_write, ms5837_read};
}

void devices_set_motor_power(struct devices *devices, bool on) {
  devices->motor_power = on;
  for (unsigned i = 0; i < FIN_COUNT && !on; i++) {
    devices->bridges[i].control = 0;  // they lose their settings without power
  }
}

uint8_t devices_exchange_spi(struct devices *devices, bool mode_0) {
  uint8_t received = 0xff;
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    if (devices->encoders[i].selected) {
      received &= as5040_exchange(&devices->encoders[i], mode_0);
    }
  }
  return received;
}

enum kind_of_device { IMU = 1, PRESSURE = 2, ENCODER = 4, BRIDGE = 8 };

static const struct {
  const char *name;
  unsigned devices;  // which can have it
} faults[] = {
    [FAULT_NONE] = {"none", IMU | PRESSURE | ENCODER | BRIDGE},
    [FAULT_ABSENT] = {"absent", IMU | PRESSURE | ENCODER | BRIDGE},
    [FAULT_STUCK] = {"stuck", IMU | PRESSURE | ENCODER | BRIDGE},
    [FAULT_REVERSED] = {"reversed", ENCODER | BRIDGE},
    [FAULT_WEAK] = {"weak", ENCODER},
    [FAULT_TRIPPED] = {"tripped", BRIDGE},
};

static enum fault *fault_of(struct devices *devices, const char *name, enum kind_of_device *kind) {
  *kind = IMU;
  if (!strcmp(name, "imu")) {
    return &devices->imu.fault;
  }
  *kind = PRESSURE;
  if (!strcmp(name, "pressure")) {
    return &devices->pressure.fault;
  }
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    char encoder[] = "encoder0", bridge[] = "bridge0";
    encoder[sizeof encoder - 2] = bridge[sizeof bridge - 2] = (char)('0' + i);
    *kind = ENCODER;
    if (!strcmp(name, encoder)) {
      return &devices->encoders[i].fault;
    }
    *kind = BRIDGE;
    if (!strcmp(name, bridge)) {
      return &devices->bridges[i].fault;
    }
  }
  return NULL;
}

bool devices_set_fault(struct devices *devices, const char *name, const char *fault) {
  enum kind_of_device kind;
  enum fault *device = fault_of(devices, name, &kind);
  if (device == &devices->imu.fault && !strcmp(fault, "dip")) {
    mpu6050_dip(&devices->imu);
    return true;
  }
  for (unsigned i = 0; device && i < sizeof faults / sizeof *faults; i++) {
    if (!strcmp(fault, faults[i].name) && faults[i].devices & kind) {
      *device = (enum fault)i;
      return true;
    }
  }
  return false;
}
