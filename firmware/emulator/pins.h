// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs on single pins: encoder selects, beacon detectors, LED, motor power, and the battery's divider.
#ifndef PINS_H
#define PINS_H

#include "as5040.h"
#include "chip.h"
#include "drv8830.h"

#define SELECT_COUNT 4

struct pins {
  struct chip *chip;
  struct as5040 *encoders;
  struct drv8830 *bridges;
  avr_irq_t *beacon_right, *beacon_left, *battery;
  bool motor_power;
  bool led;
};

void pins_create(struct pins *pins, struct chip *chip, struct as5040 encoders[SELECT_COUNT],
                 struct drv8830 bridges[SELECT_COUNT]);

// To be called after every reset of the chip: its pins no longer drive anything, and it reads its inputs
// anew.
void pins_reset(struct pins *pins, const struct surroundings *surroundings);

// Puts what the detectors and the battery show onto the chip's inputs.
void pins_show(struct pins *pins, const struct surroundings *surroundings);

#endif
