// SPDX-License-Identifier: GPL-3.0-or-later
// The single pins: encoder selects, beacon detectors, leak sensor, LED, motor power, and the battery's
// divider.
#ifndef PINS_H
#define PINS_H

#include "chip.h"
#include "devices.h"

struct pins {
  struct chip *chip;
  struct devices *devices;
  avr_irq_t *beacon_right, *beacon_left, *leak, *battery;
  bool led;
};

void pins_create(struct pins *pins, struct chip *chip, struct devices *devices);

// Call it after every reset of the chip: its pins drive nothing then, and it reads its inputs again.
void pins_reset(struct pins *pins);

// Puts the values of detectors, leak sensor and battery onto the chip's inputs.
void pins_update_inputs(struct pins *pins);
void pins_update_battery(struct pins *pins);

#endif
