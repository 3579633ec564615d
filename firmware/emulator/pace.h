// SPDX-License-Identifier: GPL-3.0-or-later
// Joins emulated time to the host's steady clock.
#ifndef PACE_H
#define PACE_H

#include "chip.h"

struct pace {
  double speed;  // emulated seconds in a real one
  double origin;
  avr_cycle_count_t origin_cycle;
  unsigned long late;  // how often the host was too slow and time was skipped
  double skipped;      // s
};

double pace_clock(void);
void pace_start(struct pace *pace, double speed, double now, avr_cycle_count_t cycle);

// The cycle that the chip should have reached. If it is too far behind, the difference is skipped.
avr_cycle_count_t pace_target(struct pace *pace, double now, avr_cycle_count_t cycle);

#endif
