// SPDX-License-Identifier: GPL-3.0-or-later
// The devices on the board beside the chip: H-bridges, motors, encoders, IMU and pressure sensor. Emulated
// chip and host board both use them.
#ifndef DEVICES_H
#define DEVICES_H

#include "as5040.h"
#include "device_clock.h"
#include "drv8830.h"
#include "motors.h"
#include "mpu6050.h"
#include "ms5837.h"
#include "surroundings.h"
#include "wiring.h"

#define I2C_DEVICES (FIN_COUNT + 2)

struct i2c_device {
  uint8_t address;  // 7 bits
  void *device;
  bool (*start)(void *device);                                // false: no acknowledgement
  void (*write)(void *device, unsigned index, uint8_t byte);  // index: bytes since the start condition
  uint8_t (*read)(void *device);
};

struct devices {
  struct surroundings surroundings;
  struct wiring wiring;
  bool motor_power;
  bool leak;  // water between the wires of the leak sensor
  struct drv8830 bridges[FIN_COUNT];
  struct as5040 encoders[FIN_COUNT];
  struct motors motors;
  struct mpu6050 imu;
  struct ms5837 pressure;
  struct i2c_device i2c[I2C_DEVICES];
};

// Creates the devices in still water, as after power-on, on a board without mistakes.
void devices_create(struct devices *devices, struct device_clock clock);

void devices_set_wiring(struct devices *devices, const struct wiring *wiring);

void devices_set_surroundings(struct devices *devices, const struct surroundings *surroundings);

void devices_set_motor_power(struct devices *devices, bool on);

// The byte on the data line of the encoders; 0xff, by the pull-up, if none is selected. `mode_0` as in spi.h.
uint8_t devices_exchange_spi(struct devices *devices, bool mode_0);

// Levels of the beacon detectors at the chip's pins: right, left. One that is not connected is pulled down.
void devices_beacons(const struct devices *devices, bool levels[2]);

// Share of the converter's range at the battery's pin.
double devices_battery(const struct devices *devices);

// Sets the fault of imu, pressure, encoder0 to 3 or bridge0 to 3: `none`, `absent`, `stuck`; of an encoder
// with a weak magnet `weak`; of an H-bridge after an overcurrent `tripped`. `dip` puts the IMU to sleep, as a
// dip of its supply does. The leak sensor is `none` or `wet`. False for other words.
bool devices_set_fault(struct devices *devices, const char *name, const char *fault);

#endif
