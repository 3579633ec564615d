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

uint8_t devices_exchange_spi(struct devices *devices) {
  uint8_t received = 0xff;
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    if (devices->encoders[i].selected) {
      received &= as5040_exchange(&devices->encoders[i]);
    }
  }
  return received;
}

static enum fault *fault_of(struct devices *devices, const char *name, bool *turns) {
  *turns = false;
  if (!strcmp(name, "imu")) {
    return &devices->imu.fault;
  }
  if (!strcmp(name, "pressure")) {
    return &devices->pressure.fault;
  }
  *turns = true;
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    char encoder[] = "encoder0", bridge[] = "bridge0";
    encoder[sizeof encoder - 2] = bridge[sizeof bridge - 2] = (char)('0' + i);
    if (!strcmp(name, encoder)) {
      return &devices->encoders[i].fault;
    }
    if (!strcmp(name, bridge)) {
      return &devices->bridges[i].fault;
    }
  }
  return NULL;
}

bool devices_set_fault(struct devices *devices, const char *name, const char *kind) {
  static const char *const kinds[] = {[FAULT_NONE] = "none",
                                      [FAULT_ABSENT] = "absent",
                                      [FAULT_STUCK] = "stuck",
                                      [FAULT_REVERSED] = "reversed"};
  bool turns;
  enum fault *fault = fault_of(devices, name, &turns);
  unsigned count = turns ? FAULT_REVERSED + 1 : FAULT_REVERSED;
  for (unsigned i = 0; fault && i < count; i++) {
    if (!strcmp(kind, kinds[i])) {
      *fault = (enum fault)i;
      return true;
    }
  }
  return false;
}
