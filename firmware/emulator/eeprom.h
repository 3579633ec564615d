// SPDX-License-Identifier: GPL-3.0-or-later
// The chip's EEPROM, stored in a file. Writing takes as long as on the chip; libsimavr writes at once.
#ifndef EEPROM_H
#define EEPROM_H

#include <avr_eeprom.h>

#include "chip.h"

struct eeprom {
  struct chip *chip;
  avr_eeprom_t *module;
  struct chip_write_hook control_written;
  struct chip_timer written;
};

void eeprom_create(struct eeprom *eeprom, struct chip *chip);

// Stores the contents in this file from now on; a new file begins erased. False with a reason on failure.
bool eeprom_open(struct eeprom *eeprom, const char *path, char *reason, size_t reason_size);

// Writes the emulated robot's calibration into it, unless it holds one that the firmware accepts: a whole
// record of the present layout.
void eeprom_calibrate(struct eeprom *eeprom);

// Copies the other's contents and file.
void eeprom_copy(struct eeprom *eeprom, const struct eeprom *other);

#endif
