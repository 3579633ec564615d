// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs on single pins: encoder selects, beacon detectors, LED, motor power, and the battery's divider.
#ifndef PINS_H
#define PINS_H

#include "chip.h"
#include "devices.h"

struct pins {
  struct chip *chip;
  struct devices *devices;
  avr_irq_t *beacon_right, *beacon_left, *battery;
  bool led;
};

void pins_create(struct pins *pins, struct chip *chip, struct devices *devices);

// To be called after every reset of the chip: its pins no longer drive anything, and it reads its inputs
// anew.
void pins_reset(struct pins *pins);

// Puts what the detectors and the battery show onto the chip's inputs.
void pins_show(struct pins *pins);

#endif
