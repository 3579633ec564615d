// SPDX-License-Identifier: GPL-3.0-or-later
// The four gear motors with their fins and encoders. A motor's torque falls with its speed; friction, which
// holds a motor that rests up to a torque, and the water, which resists the fin with the square of its speed,
// act against it. A fin turns with its motor's
// shaft.
#ifndef MOTORS_H
#define MOTORS_H

#include "as5040.h"
#include "drv8830.h"
#include "wiring.h"

#define MOTORS_PERIOD 1e-3  // s

struct motors {
  const struct drv8830 *bridges;
  struct as5040 *encoders;
  const struct surroundings *surroundings;
  const struct wiring *wiring;
  double rotor[FIN_COUNT];  // rad, of the gear's side to the motor, growing with positive drive
  double rotor_speed[FIN_COUNT];
  double shaft[FIN_COUNT];  // rad, of its side to the fin
  double speed[FIN_COUNT];  // rad/s
  double current;           // A, from the battery
  unsigned steps;           // since power-on
  uint32_t noise;
};

void motors_create(struct motors *motors, const struct drv8830 bridges[FIN_COUNT],
                   struct as5040 encoders[FIN_COUNT], const struct surroundings *surroundings,
                   const struct wiring *wiring);

// V, of the battery with the motors as its load.
double motors_battery(const struct motors *motors);

// Call it every MOTORS_PERIOD.
void motors_step(struct motors *motors);

// Somebody turns a fin to this angle (rad).
void motors_turn_by_hand(struct motors *motors, unsigned fin, double angle);

// A fin's angle (rad, -pi to pi) and speed (rad/s); fins 0 to 3 are front right, back right, back left,
// front left.
double motors_fin_angle(const struct motors *motors, unsigned fin);
double motors_fin_speed(const struct motors *motors, unsigned fin);

#endif
