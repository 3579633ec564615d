// SPDX-License-Identifier: GPL-3.0-or-later
#include "motors.h"

#include <math.h>
#include <stdlib.h>

#define TIME_CONSTANT 30e-3   // s
#define SPEED_PER_STEP 0.315  // rad/s for each step of the bridge's voltage: 12.6 rad/s at 40
#define FRICTION_STEPS 2      // below this drive a motor stands still
#define STANDSTILL 0.02       // rad/s at which friction holds it
#define ENCODER_SIGN (-1)

static const double encoder_zero[FIN_COUNT] = {188, 161, 726, 356};
static const int rotation_sign[FIN_COUNT] = {1, 1, -1, -1};
// Fin angles at power-on, never exactly in place; rad.
static const double first_angle[FIN_COUNT] = {0.05, -0.04, 0.03, -0.06};

static void turn(struct motors *motors, unsigned fin, double driven) {
  double decay = exp(-MOTORS_PERIOD / TIME_CONSTANT);
  double behind = motors->speed[fin] - driven;
  motors->shaft[fin] += driven * MOTORS_PERIOD + behind * TIME_CONSTANT * (1 - decay);
  double speed = driven + behind * decay;
  motors->speed[fin] = driven == 0 && fabs(speed) < STANDSTILL ? 0 : speed;
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
    int drive = drv8830_drive(&motors->bridges[fin]);
    double driven = abs(drive) < FRICTION_STEPS ? 0 : SPEED_PER_STEP * drive;
    turn(motors, fin, driven);
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
