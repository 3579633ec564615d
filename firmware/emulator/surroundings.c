// SPDX-License-Identifier: GPL-3.0-or-later
#include "surroundings.h"

#include <math.h>

static bool possible(const struct surroundings *felt) {
  double sum = felt->pressure + felt->temperature + felt->battery;
  for (unsigned axis = 0; axis < 3; axis++) {
    sum += felt->force[axis] + felt->rate[axis];
  }
  for (unsigned fin = 0; fin < 4; fin++) {
    if (fabs(felt->encoder_error[fin]) > M_PI) {
      return false;
    }
  }
  return isfinite(sum) && felt->pressure >= 0 && felt->battery >= 0;
}

bool surroundings_read(struct surroundings *surroundings, const double n[SURROUNDINGS_NUMBERS]) {
  if (!isfinite(n[8]) || !isfinite(n[9])) {
    return false;
  }
  struct surroundings felt = {
      .pressure = n[0],
      .temperature = n[1],
      .force = {n[2], n[3], n[4]},
      .rate = {n[5], n[6], n[7]},
      .beacon_right = n[8] != 0,
      .beacon_left = n[9] != 0,
      .battery = n[10],
      .encoder_error = {n[11], n[12], n[13], n[14]},
  };
  bool can_be = possible(&felt);
  if (can_be) {
    *surroundings = felt;
  }
  return can_be;
}
