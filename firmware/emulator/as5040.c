// SPDX-License-Identifier: GPL-3.0-or-later
#include "as5040.h"

#include <math.h>

#define STATUS_READY 0x10   // OCF: the offset compensation has finished
#define STATUS_YELLOW 0x03  // MagINC and MagDEC
#define STATUS_BITS 5

void as5040_turn(struct as5040 *encoder, double ticks) {
  if (encoder->fault != FAULT_STUCK) {
    encoder->position = (unsigned)(lround(ticks) & (AS5040_TICKS - 1));
  }
}

static uint32_t word(const struct as5040 *encoder) {
  unsigned status = (encoder->ready ? STATUS_READY : 0) | (encoder->fault == FAULT_WEAK ? STATUS_YELLOW : 0);
  uint32_t bits = encoder->position << STATUS_BITS | status;
  return bits << 1 | (uint32_t)__builtin_parity(bits);
}

void as5040_select(struct as5040 *encoder, bool selected) {
  if (selected && !encoder->selected) {
    encoder->shift = 0x80000000u | word(encoder) << 15;
    encoder->begun = false;
  }
  encoder->selected = selected;
}

// Without an encoder the pull-up holds the line high.
uint8_t as5040_exchange(struct as5040 *encoder, bool mode_0) {
  if (encoder->fault == FAULT_ABSENT) {
    return 0xff;
  }
  // The first falling edge latches the word. A clock that rests low rises before that, and is read once more.
  if (mode_0 && !encoder->begun) {
    encoder->shift = 0x80000000u | encoder->shift >> 1;
  }
  encoder->begun = true;
  uint8_t byte = (uint8_t)(encoder->shift >> 24);
  encoder->shift <<= 8;
  return byte;
}
