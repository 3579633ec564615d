// SPDX-License-Identifier: GPL-3.0-or-later
#include "surroundings.h"

#include <math.h>

static bool possible(const struct surroundings *reading) {
  double sum = reading->pressure + reading->temperature + reading->battery + reading->fin_load;
  for (unsigned axis = 0; axis < 3; axis++) {
    sum += reading->force[axis] + reading->rate[axis];
  }
  for (unsigned fin = 0; fin < 4; fin++) {
    if (fabs(reading->encoder_error[fin]) > M_PI) {
      return false;
    }
  }
  return isfinite(sum) && reading->pressure >= 0 && reading->battery >= 0 && reading->fin_load >= 0;
}

bool surroundings_read(struct surroundings *surroundings, const double n[SURROUNDINGS_NUMBERS]) {
  if (!isfinite(n[8]) || !isfinite(n[9])) {
    return false;
  }
  struct surroundings reading = {
      .pressure = n[0],
      .temperature = n[1],
      .force = {n[2], n[3], n[4]},
      .rate = {n[5], n[6], n[7]},
      .beacon_right = n[8] != 0,
      .beacon_left = n[9] != 0,
      .battery = n[10],
      .encoder_error = {n[11], n[12], n[13], n[14]},
      .fin_load = n[15],
  };
  bool can_be = possible(&reading);
  if (can_be) {
    *surroundings = reading;
  }
  return can_be;
}
