// SPDX-License-Identifier: GPL-3.0-or-later
#include "motors.h"

#include <math.h>

// A gear motor of the size that fits: at 6 V 220 rpm without load and 0.235 N m stalled (Pololu's 150:1 HP).
// Its 12.3 rad/s at the 3.2 V of a drive of 40 are about what is taken for the robot.
#define SPEED_PER_STEP 0.315  // rad/s without load, for each step of the bridge's voltage: 12.6 rad/s at 40
#define TORQUE_SLOPE 0.0102   // N m for each rad/s by which it is slower than without load
#define FRICTION_STEPS 2      // below this drive a motor stands still
#define FRICTION (FRICTION_STEPS * SPEED_PER_STEP * TORQUE_SLOPE)
// Motor and fin, with the water that moves along. A plate of this size has pi/4 * 1000 * chord^2 * R^3 / 3 =
// 4.7e-4 kg m^2 at most; this makes a time constant of 30 ms.
#define INERTIA (TORQUE_SLOPE * 30e-3)
// The water resists each strip of a fin with half * rho * C_N * chord * (r * speed)^2 at its distance r from
// the shaft. Over the fin's length R, with chord = S / R, the torque is half * rho * C_N * S * R^3 / 4 *
// speed^2. S and R are published, C_N is that of a flat plate, as in the simulated water.
#define FIN_AREA 0.0045   // m^2
#define FIN_LENGTH 0.088  // m
#define FIN_NORMAL 2.0
#define WATER_DENSITY 1000.0  // kg/m^3
#define WATER_DRAG (0.5 * WATER_DENSITY * FIN_NORMAL * FIN_AREA * FIN_LENGTH * FIN_LENGTH * FIN_LENGTH / 4)
#define ENCODER_SIGN (-1)

static const double encoder_zero[FIN_COUNT] = {188, 161, 726, 356};
static const int rotation_sign[FIN_COUNT] = {1, 1, -1, -1};
// Fin angles at power-on, never exactly in place; rad.
static const double first_angle[FIN_COUNT] = {0.05, -0.04, 0.03, -0.06};

// The speed after a step: implicit where torque grows with the speed, so that no step is too long. Friction
// only ever stops.
static double speed_after(double speed, int drive, bool coasts) {
  double step = MOTORS_PERIOD / INERTIA;
  double slope = coasts ? 0 : TORQUE_SLOPE;
  double ideal = SPEED_PER_STEP * (drive + (drive > 0 ? FRICTION_STEPS : drive < 0 ? -FRICTION_STEPS : 0));
  double pushed = speed + step * slope * ideal;
  double stopped = step * FRICTION;
  if (fabs(pushed) <= stopped) {
    return 0;
  }
  return (pushed - copysign(stopped, pushed)) / (1 + step * (slope + WATER_DRAG * fabs(speed)));
}

static void turn(struct motors *motors, unsigned fin) {
  const struct drv8830 *bridge = &motors->bridges[fin];
  double before = motors->speed[fin];
  motors->speed[fin] = speed_after(before, drv8830_drive(bridge), drv8830_coasts(bridge));
  motors->shaft[fin] += MOTORS_PERIOD * (before + motors->speed[fin]) / 2;
}

static void show(struct motors *motors, unsigned fin) {
  double error = motors->surroundings->encoder_error[fin];
  if (isnan(error)) {
    return;
  }
  double ticks = (motors->shaft[fin] + rotation_sign[fin] * error) * AS5040_TICKS / (2 * M_PI);
  as5040_turn(&motors->encoders[fin], encoder_zero[fin] + ENCODER_SIGN * ticks);
}

void motors_step(struct motors *motors) {
  for (unsigned fin = 0; fin < FIN_COUNT; fin++) {
    turn(motors, fin);
    show(motors, fin);
  }
}

void motors_create(struct motors *motors, const struct drv8830 bridges[FIN_COUNT],
                   struct as5040 encoders[FIN_COUNT], const struct surroundings *surroundings) {
  *motors = (struct motors){.bridges = bridges, .encoders = encoders, .surroundings = surroundings};
  for (unsigned fin = 0; fin < FIN_COUNT; fin++) {
    motors->shaft[fin] = rotation_sign[fin] * first_angle[fin];
    show(motors, fin);
  }
}

double motors_fin_angle(const struct motors *motors, unsigned fin) {
  return remainder(rotation_sign[fin] * motors->shaft[fin], 2 * M_PI);
}

double motors_fin_speed(const struct motors *motors, unsigned fin) {
  return rotation_sign[fin] * motors->speed[fin] + 0.0;  // and never -0
}
