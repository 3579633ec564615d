// SPDX-License-Identifier: GPL-3.0-or-later
// ams AS5040: a 10-bit magnetic encoder, read through its synchronous serial interface.
//
// The data line is high from chip select to the first rising edge of the clock. So a master that samples on
// rising edges (SPI mode 3) reads a 1 and then the word: D9 to D0, OCF, COF, LIN, MagINC, MagDEC, even
// parity.
#ifndef AS5040_H
#define AS5040_H

#include <stdint.h>

#include "surroundings.h"

#define AS5040_TICKS 1024

struct as5040 {
  unsigned position;  // ticks
  uint32_t shift;     // bits still to send, the uppermost first
  bool selected;
  bool begun;  // a byte was exchanged since the select
  bool ready;  // it has compensated its offsets since power-on
  enum fault fault;
};

void as5040_turn(struct as5040 *encoder, double ticks);
void as5040_select(struct as5040 *encoder, bool selected);
uint8_t as5040_exchange(struct as5040 *encoder, bool mode_0);

#endif
