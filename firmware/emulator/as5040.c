// SPDX-License-Identifier: GPL-3.0-or-later
#include "as5040.h"

#include <math.h>

#define STATUS_READY 0x10  // OCF: the offset compensation has finished; none of the other status bits
#define STATUS_BITS 5

void as5040_turn(struct as5040 *encoder, double ticks) {
  if (encoder->fault != FAULT_STUCK) {
    long turned = lround(encoder->fault == FAULT_REVERSED ? -ticks : ticks);
    encoder->position = (unsigned)(turned & (AS5040_TICKS - 1));
  }
}

static uint32_t word(unsigned position) {
  uint32_t bits = position << STATUS_BITS | STATUS_READY;
  return bits << 1 | (uint32_t)__builtin_parity(bits);
}

void as5040_select(struct as5040 *encoder, bool selected) {
  if (selected && !encoder->selected) {
    encoder->shift = 0x80000000u | word(encoder->position) << 15;
  }
  encoder->selected = selected;
}

// Without an encoder the pull-up holds the line high.
uint8_t as5040_exchange(struct as5040 *encoder) {
  if (encoder->fault == FAULT_ABSENT) {
    return 0xff;
  }
  uint8_t byte = (uint8_t)(encoder->shift >> 24);
  encoder->shift <<= 8;
  return byte;
}
