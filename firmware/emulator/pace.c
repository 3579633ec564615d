// SPDX-License-Identifier: GPL-3.0-or-later
#include "pace.h"

#include <time.h>

#define BEHIND_MAX 0.1  // s

double pace_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void pace_start(struct pace *pace, double speed, double now, avr_cycle_count_t cycle) {
  *pace = (struct pace){.speed = speed, .origin = now, .origin_cycle = cycle};
}

avr_cycle_count_t pace_target(struct pace *pace, double now, avr_cycle_count_t cycle) {
  double due = (now - pace->origin) * pace->speed;
  double behind = due - chip_seconds(cycle - pace->origin_cycle);
  if (behind > BEHIND_MAX * pace->speed) {
    pace->late++;
    pace->skipped += behind / pace->speed;
    pace->origin = now;
    pace->origin_cycle = cycle;
    return cycle;
  }
  return pace->origin_cycle + chip_cycles(due);
}
