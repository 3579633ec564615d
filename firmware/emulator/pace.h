// SPDX-License-Identifier: GPL-3.0-or-later
// Joins emulated time to the host's steady clock.
#ifndef PACE_H
#define PACE_H

#include "chip.h"

struct pace {
  double speed;  // emulated seconds in a real one
  double origin;
  avr_cycle_count_t origin_cycle;
  unsigned long late;  // times that the host was too slow, and time was skipped
  double skipped;      // s
};

double pace_clock(void);
void pace_start(struct pace *pace, double speed, double now, avr_cycle_count_t cycle);

// The cycle that the chip ought to be at. Where it is too far behind, it need not catch up.
avr_cycle_count_t pace_target(struct pace *pace, double now, avr_cycle_count_t cycle);

#endif
