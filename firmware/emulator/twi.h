// SPDX-License-Identifier: GPL-3.0-or-later
// The I2C bus, at the speed that the program has set, with its devices.
//
// libsimavr takes 9 µs for every character at any bus clock, and reports an absent device like a refused data
// byte. Both are corrected here.
#ifndef TWI_H
#define TWI_H

#include <avr_twi.h>

#include "chip.h"
#include "devices.h"

#define TWI_DEVICES_MAX 8

struct twi {
  struct chip *chip;
  avr_twi_t *module;
  struct chip_write_hook control_written;
  struct i2c_device devices[TWI_DEVICES_MAX];
  unsigned device_count;
  struct i2c_device *selected;
  unsigned index;
  bool addressed;                // the address was sent, and its status is not corrected yet
  avr_cycle_count_t timer_when;  // of the corrected timer
};

void twi_create(struct twi *twi, struct chip *chip);
void twi_attach(struct twi *twi, struct i2c_device device);
void twi_reset(struct twi *twi);

#endif
