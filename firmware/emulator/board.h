// SPDX-License-Identifier: GPL-3.0-or-later
// The board: the chip, everything that hangs on it, and the serial line to the host.
#ifndef BOARD_H
#define BOARD_H

#include "chip.h"
#include "drv8830.h"
#include "eeprom.h"
#include "host_port.h"
#include "motors.h"
#include "mpu6050.h"
#include "ms5837.h"
#include "pins.h"
#include "spi.h"
#include "twi.h"
#include "uart.h"

struct board {
  struct chip chip;
  struct surroundings surroundings;
  struct pty *pty;
  struct uart uart;
  struct host_port host;
  struct twi twi;
  struct spi spi;
  struct eeprom eeprom;
  struct drv8830 bridges[FIN_COUNT];
  struct as5040 encoders[FIN_COUNT];
  struct motors motors;
  struct mpu6050 imu;
  struct ms5837 pressure;
  struct pins pins;
};

// A board without a program, in still water.
bool board_create(struct board *board, struct pty *pty);

// Takes the power away and gives it back: everything is as after `board_create`, the chip's time too, but for
// flash memory, EEPROM and surroundings. The reset is the caller's, as is what hangs on the chip's timers.
bool board_renew(struct board *board);

void board_feel(struct board *board, const struct surroundings *surroundings);

// The device of this name, or NULL: imu, pressure, encoder0 to 3, bridge0 to 3.
enum fault *board_fault(struct board *board, const char *device);

#endif
