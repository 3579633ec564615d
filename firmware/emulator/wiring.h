// SPDX-License-Identifier: GPL-3.0-or-later
// How one board is wired, and what is imperfect about its parts. Mistakes change it; see mistakes.h.
#ifndef WIRING_H
#define WIRING_H

#include <stdbool.h>
#include <stdint.h>

#define FIN_COUNT 4
#define NOT_CONNECTED (-1)
#define NO_ADDRESS 0xff

struct chip_axis {
  int body;  // the body axis along which it lies: 0 forward, 1 right, 2 down
  int sign;
};

struct wiring {
  int bridge[FIN_COUNT];    // the H-bridge that drives each motor
  int leads[FIN_COUNT];     // of each motor, 1 or -1
  int shaft[FIN_COUNT];     // the shaft that the encoder at each select measures
  int counting[FIN_COUNT];  // of each encoder, 1 or -1
  uint8_t bridge_address[FIN_COUNT];
  uint8_t imu_address, imu_identity;
  uint8_t pressure_address;
  struct chip_axis imu_axes[3];
  bool beacon_connected[2];  // right, left
  bool beacons_inverted, beacons_swapped;
  double divider;          // the battery's voltage over that at the pin
  double reference;        // V, of the chip's converter
  double gyro_offset[3];   // rad/s, about the chip's axes
  double gyro_drift[3];    // rad/s for each °C above GYRO_CALIBRATED
  double encoder_noise;    // ticks to either side, every value alike
  double backlash;         // rad, of each fin's gear
  double stiction;         // drive below which a motor that rests stays at rest, of all fins
  double pack_resistance;  // ohm
};

// As the board is meant to be.
#define RIGHT_WIRING                                                                                  \
  {                                                                                                   \
    .bridge = {0, 1, 2, 3}, .leads = {1, 1, 1, 1}, .shaft = {0, 1, 2, 3}, .counting = {1, 1, 1, 1},   \
    .bridge_address = {0x64, 0x60, 0x61, 0x63}, .imu_address = 0x69, .imu_identity = 0x68,            \
    .pressure_address = 0x76, .imu_axes = {{0, 1}, {1, 1}, {2, 1}}, .beacon_connected = {true, true}, \
    .divider = 2, .reference = 5, .stiction = 2                                                       \
  }

#endif
