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
  double encoder_error[4];  // rad by which a fin's encoder shows too much; NAN: it shows what it last showed
};

// At the surface of still water, level and at rest, with a charged battery.
#define STILL_WATER \
  { .pressure = 101325, .temperature = 20, .force = {0, 0, -9.80665}, .battery = 7.4 }

// PRESSURE TEMPERATURE FX FY FZ P Q R BEACON_RIGHT BEACON_LEFT BATTERY E0 E1 E2 E3
#define SURROUNDINGS_NUMBERS 15

// Takes over what these numbers tell; false, and nothing taken over, where that cannot be.
bool surroundings_read(struct surroundings *surroundings, const double numbers[SURROUNDINGS_NUMBERS]);

// What may be wrong with a device: it does not answer, or it goes on showing what it last showed.
enum fault { FAULT_NONE, FAULT_ABSENT, FAULT_STUCK };

#endif
