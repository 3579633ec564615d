// SPDX-License-Identifier: GPL-3.0-or-later
// One direction of a serial line, bit by bit: 8N1 characters are sent at the sender's bit time and sampled at
// the receiver's. Ends of different speeds see garbage and framing errors.
#ifndef LINE_H
#define LINE_H

#include "chip.h"
#include "line_faults.h"

// A power of two. Between ends of like speed at most two are on the line at a time, and two more for each by
// faults. A receiver that is much slower than the sender misses those beyond.
#define LINE_CHARACTERS_MAX 16

struct line_character {
  double start;     // cycle of its start bit's edge
  double bit;       // cycles
  unsigned levels;  // of its ten bits, the start bit being bit 0
};

struct line {
  struct chip *chip;
  struct line_character characters[LINE_CHARACTERS_MAX];
  unsigned head, tail;
  double sender_free;    // cycle at which the last character ends
  double receiver_bit;   // cycles
  double receiver_free;  // cycle from which the receiver looks for a start bit
  double edge;           // the start bit that it is sampling from
  bool receiving;
  struct line_faults faults;
  struct chip_timer sampled;
  void (*deliver)(void *owner, uint8_t byte, bool framing_error);
  void *owner;
};

void line_create(struct line *line, struct chip *chip, double receiver_bit,
                 void (*deliver)(void *owner, uint8_t byte, bool framing_error), void *owner);

// Sends a character after those on the line; returns the cycle at which it ends.
double line_send(struct line *line, uint8_t byte, double bit);

// Interrupts the sender within a character: the line goes high.
void line_cut(struct line *line);

// Drops all characters, also one that the receiver is sampling.
void line_clear(struct line *line);

#endif
