// SPDX-License-Identifier: GPL-3.0-or-later
// The chip's EEPROM, kept in a file, and as slow to write as the chip's: libsimavr writes at once.
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

// Keeps the contents in this file from now on; a file that is not there begins erased. False with a reason.
bool eeprom_open(struct eeprom *eeprom, const char *path, char *reason, size_t reason_size);

// Takes over what the other keeps, and its file.
void eeprom_inherit(struct eeprom *eeprom, const struct eeprom *other);

#endif
