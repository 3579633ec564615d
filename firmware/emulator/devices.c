// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static void find_addresses(struct devices *devices) {
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    devices->i2c[i].address = devices->wiring.bridge_address[i];
  }
  devices->i2c[FIN_COUNT].address = devices->wiring.imu_address;
  devices->i2c[FIN_COUNT + 1].address = devices->wiring.pressure_address;
}

void devices_create(struct devices *devices, struct device_clock clock) {
  *devices = (struct devices){.surroundings = STILL_WATER, .wiring = RIGHT_WIRING};
  mpu6050_create(&devices->imu, clock, &devices->surroundings, &devices->wiring);
  ms5837_create(&devices->pressure, clock, &devices->surroundings);
  motors_create(&devices->motors, devices->bridges, devices->encoders, &devices->surroundings,
                &devices->wiring);
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    devices->bridges[i].powered = &devices->motor_power;
    devices->i2c[i] = (struct i2c_device){
        .device = &devices->bridges[i], .start = drv8830_start, .write = drv8830_write, .read = drv8830_read};
  }
  devices->i2c[FIN_COUNT] = (struct i2c_device){
      .device = &devices->imu, .start = mpu6050_start, .write = mpu6050_write, .read = mpu6050_read};
  devices->i2c[FIN_COUNT + 1] = (struct i2c_device){
      .device = &devices->pressure, .start = ms5837_start, .write = ms5837_write, .read = ms5837_read};
  find_addresses(devices);
}

void devices_set_wiring(struct devices *devices, const struct wiring *wiring) {
  bool another_imu = devices->wiring.imu_identity != wiring->imu_identity;
  devices->wiring = *wiring;
  if (another_imu) {
    mpu6050_dip(&devices->imu);  // as its power-on leaves it
  }
  find_addresses(devices);
}

void devices_set_surroundings(struct devices *devices, const struct surroundings *surroundings) {
  mpu6050_filter(&devices->imu);
  devices->surroundings = *surroundings;
}

void devices_beacons(const struct devices *devices, bool levels[2]) {
  const struct wiring *wiring = &devices->wiring;
  bool heard[2] = {devices->surroundings.beacon_right, devices->surroundings.beacon_left};
  for (unsigned side = 0; side < 2; side++) {
    unsigned detector = wiring->beacons_swapped ? 1 - side : side;
    levels[side] = wiring->beacon_connected[side] && heard[detector] != wiring->beacons_inverted;
  }
}

double devices_battery(const struct devices *devices) {
  const struct wiring *wiring = &devices->wiring;
  return fmin(motors_battery(&devices->motors) / wiring->divider / wiring->reference, 1);
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
    if (devices->encoders[i].selected && devices->wiring.shaft[i] != NOT_CONNECTED) {
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
    [FAULT_WEAK] = {"weak", ENCODER},
    [FAULT_TRIPPED] = {"tripped", BRIDGE},
};

// The fin in a name such as `encoder3`, or -1.
static int numbered(const char *name, const char *kind) {
  size_t length = strlen(kind);
  bool matches = !strncmp(name, kind, length) && name[length] >= '0' && name[length] < '0' + FIN_COUNT;
  return matches && !name[length + 1] ? name[length] - '0' : -1;
}

static enum fault *fault_of(struct devices *devices, const char *name, enum kind_of_device *kind) {
  *kind = IMU;
  if (!strcmp(name, "imu")) {
    return &devices->imu.fault;
  }
  *kind = PRESSURE;
  if (!strcmp(name, "pressure")) {
    return &devices->pressure.fault;
  }
  *kind = ENCODER;
  int fin = numbered(name, "encoder");
  if (fin >= 0) {
    return &devices->encoders[fin].fault;
  }
  *kind = BRIDGE;
  fin = numbered(name, "bridge");
  return fin >= 0 ? &devices->bridges[fin].fault : NULL;
}

bool devices_set_fault(struct devices *devices, const char *name, const char *fault) {
  if (!strcmp(name, "leak")) {
    devices->leak = !strcmp(fault, "wet");
    return devices->leak || !strcmp(fault, "none");
  }
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
