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

// Of the bus: a device holds SDA low until it has got nine clocks in a row; one refuses every byte of data;
// one stretches the clock of every character; something pulls SDA down within every character that the chip
// sends, so that it loses the arbitration.
enum twi_fault {
  TWI_FAULT_NONE,
  TWI_FAULT_STUCK,
  TWI_FAULT_REFUSED,
  TWI_FAULT_STRETCHED,
  TWI_FAULT_CONTESTED
};

struct twi {
  struct chip *chip;
  avr_twi_t *module;
  struct chip_write_hook control_written;
  struct chip_write_hook direction_written;
  enum twi_fault fault;
  bool clock_low;   // by the pin's direction, without the TWI
  unsigned clocks;  // in a row, since the TWI last tried
  const struct i2c_device *devices[TWI_DEVICES_MAX];
  bool selected[TWI_DEVICES_MAX];  // several, where they share an address
  unsigned device_count;
  uint8_t address;
  unsigned index;
  bool addressed;                // the address was sent, and its status is not corrected yet
  avr_cycle_count_t timer_when;  // of the corrected timer
};

void twi_create(struct twi *twi, struct chip *chip);
void twi_attach(struct twi *twi, const struct i2c_device *device);
void twi_reset(struct twi *twi);
// Sets the bus's fault: none, stuck, refused, stretched or contested. False for other words.
bool twi_set_fault(struct twi *twi, const char *fault);

#endif
