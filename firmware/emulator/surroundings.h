// SPDX-License-Identifier: GPL-3.0-or-later
// The physical quantities at the sensors. Body axes are forward, right, down.
#ifndef SURROUNDINGS_H
#define SURROUNDINGS_H

#include <stdbool.h>

struct surroundings {
  double pressure;     // Pa, absolute
  double temperature;  // °C
  double force[3];     // m/s², specific force
  double rate[3];      // rad/s
  bool beacon_right, beacon_left;
  double battery;           // V
  double encoder_error[4];  // rad, error of each fin's encoder; NAN: it repeats its last reading
  double fin_load;          // of the water on each fin's motor, as a share of that on the published fin
};

// At the surface of still water, level and at rest, with a charged battery.
#define STILL_WATER \
  { .pressure = 101325, .temperature = 20, .force = {0, 0, -9.80665}, .battery = 7.4, .fin_load = 1 }

// PRESSURE TEMPERATURE FX FY FZ P Q R BEACON_RIGHT BEACON_LEFT BATTERY E0 E1 E2 E3 FIN_LOAD
#define SURROUNDINGS_NUMBERS 16

// Sets the surroundings to these numbers; false, without a change, if they are impossible.
bool surroundings_read(struct surroundings *surroundings, const double numbers[SURROUNDINGS_NUMBERS]);

// Fault of a device: it does not answer, or it repeats its last reading.
enum fault { FAULT_NONE, FAULT_ABSENT, FAULT_STUCK, FAULT_WEAK, FAULT_TRIPPED };

#endif
