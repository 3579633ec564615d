// SPDX-License-Identifier: GPL-3.0-or-later
// The board: the chip, everything connected to it, and the serial line to the host.
#ifndef BOARD_H
#define BOARD_H

#include "chip.h"
#include "devices.h"
#include "eeprom.h"
#include "host_port.h"
#include "pins.h"
#include "spi.h"
#include "twi.h"
#include "uart.h"

struct board {
  struct chip chip;
  struct devices devices;
  struct chip_timer motors_due;
  struct pty *pty;
  struct uart uart;
  struct host_port host;
  struct twi twi;
  struct spi spi;
  struct eeprom eeprom;
  struct pins pins;
};

// A board without a program, in still water.
bool board_create(struct board *board, struct pty *pty);

// Switches the power off and on. Everything is as after `board_create`, the chip's time too, except flash
// memory, EEPROM, wiring and surroundings. The caller resets the chip and restarts what uses the chip's
// timers.
bool board_power_cycle(struct board *board);

void board_set_surroundings(struct board *board, const struct surroundings *surroundings);
void board_set_wiring(struct board *board, const struct wiring *wiring);

#endif
