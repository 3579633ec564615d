// SPDX-License-Identifier: GPL-3.0-or-later
// Texas Instruments DRV8830: an H-bridge on I2C that holds a voltage of about 0.08 V for each step of its
// VSET. The motors' power supplies its logic: without it the chip does not answer and loses its settings.
#ifndef DRV8830_H
#define DRV8830_H

#include <stdbool.h>
#include <stdint.h>

#include "surroundings.h"

struct drv8830 {
  const bool *powered;
  uint8_t pointer;
  uint8_t control;
  enum fault fault;
};

// Signed steps of voltage, -63 to 63; positive is IN1.
int drv8830_drive(const struct drv8830 *bridge);

// True if its outputs are open. At drive 0 it brakes otherwise: both inputs are 1 and short the motor.
bool drv8830_coasts(const struct drv8830 *bridge);

bool drv8830_start(void *bridge);
void drv8830_write(void *bridge, unsigned index, uint8_t byte);
uint8_t drv8830_read(void *bridge);

#endif
