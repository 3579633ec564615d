// SPDX-License-Identifier: GPL-3.0-or-later
// The SPI bus with the chip as its master. libsimavr takes 100 µs for every byte whatever the clock is; here
// a byte takes eight of the clock's periods.
#ifndef SPI_H
#define SPI_H

#include <avr_spi.h>

#include "chip.h"

struct spi {
  struct chip *chip;
  avr_spi_t *module;
  struct chip_write_hook data_written;
  uint8_t (*exchange)(void *owner, uint8_t sent, bool mode_0);
  void *owner;
};

// `exchange` is called with every byte sent and returns the byte received. `mode_0`: the clock rests low, and
// bits are read at its first edge.
void spi_create(struct spi *spi, struct chip *chip,
                uint8_t (*exchange)(void *owner, uint8_t sent, bool mode_0), void *owner);

#endif
