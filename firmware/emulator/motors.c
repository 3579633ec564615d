// SPDX-License-Identifier: GPL-3.0-or-later
#include "motors.h"

#include <math.h>

// A gear motor of the size that fits: at 6 V 220 rpm without load and 0.235 N m stalled (Pololu's 150:1 HP).
// Its 12.3 rad/s at the 3.2 V of a drive of 40 are about what is taken for the robot.
#define SPEED_PER_STEP 0.315  // rad/s without friction, for each step of the bridge's voltage
#define TORQUE_SLOPE 0.0102   // N m for each rad/s by which it is slower than that
// Of the torque that a motor at rest needs to break away: what resists it once it turns. Dry friction and
// shaft seals need more to start than to go on.
#define SLIDING_SHARE 0.8
// Motor and fin, with the water that moves along. A plate of this size has pi/4 * 1000 * chord^2 * R^3 / 3 =
// 4.7e-4 kg m^2 at most; this makes a time constant of 30 ms.
#define INERTIA (TORQUE_SLOPE * 30e-3)
// The water resists each strip of a fin with half * rho * C_N * chord * (r * speed)^2 at its distance r from
// the shaft. Over the fin's length R, with chord = S / R, the torque is half * rho * C_N * S * R^3 / 4 *
// speed^2. S and R are published, C_N is that of a flat plate, as in the simulated water; other fins come
// as a load of their own.
#define FIN_AREA 0.0045   // m^2
#define FIN_LENGTH 0.088  // m
#define FIN_NORMAL 2.0
#define WATER_DENSITY 1000.0  // kg/m^3
#define WATER_DRAG (0.5 * WATER_DENSITY * FIN_NORMAL * FIN_AREA * FIN_LENGTH * FIN_LENGTH * FIN_LENGTH / 4)
#define ENCODER_SIGN (-1)
#define READY_STEPS 50           // an encoder compensates its offsets for 50 ms after power-on
#define VOLTS_PER_STEP 0.0803    // of an H-bridge
#define AMPERES_PER_TORQUE 6.38  // of that motor: 1.5 A stalled
#define SUPPLY_MIN 1.0           // V; a battery that sags so far is empty

static const double encoder_zero[FIN_COUNT] = {188, 161, 726, 356};
static const int rotation_sign[FIN_COUNT] = {1, 1, -1, -1};
// Fin angles at power-on, never exactly in place; rad.
static const double first_angle[FIN_COUNT] = {0.05, -0.04, 0.03, -0.06};

// rad/s at which a motor has no torque left.
static double ideal_speed(double drive) { return SPEED_PER_STEP * drive; }

// N m that act against a motor's turning.
static double friction(const struct motors *motors, double speed) {
  return motors->wiring->stiction * SPEED_PER_STEP * TORQUE_SLOPE * (speed == 0 ? 1 : SLIDING_SHARE);
}

// The speed after a step: implicit where torque grows with the speed, so that no step is too long. Friction
// only ever stops.
static double speed_after(double speed, double friction, double fin_speed, double load, double drive,
                          bool coasts) {
  double step = MOTORS_PERIOD / INERTIA;
  double slope = coasts ? 0 : TORQUE_SLOPE;
  double pushed = speed + step * slope * ideal_speed(drive);
  double stopped = step * friction;
  if (fabs(pushed) <= stopped) {
    return 0;
  }
  return (pushed - copysign(stopped, pushed)) / (1 + step * (slope + WATER_DRAG * load * fabs(fin_speed)));
}

// A, from the battery. An H-bridge is a converter: it draws the motor's power. What a motor gives back is
// lost.
static double current(const struct motors *motors, double drive, double speed) {
  double amperes = AMPERES_PER_TORQUE * TORQUE_SLOPE * (ideal_speed(drive) - speed);
  double watts = amperes * VOLTS_PER_STEP * drive;
  return watts > 0 ? watts / fmax(motors_battery(motors), SUPPLY_MIN) : 0;
}

double motors_battery(const struct motors *motors) {
  return fmax(motors->surroundings->battery - motors->wiring->pack_resistance * motors->current, 0);
}

// A gear with backlash: the fin's side rests until the motor's side has crossed the gap.
static void turn_fin(struct motors *motors, unsigned fin) {
  double gap = motors->wiring->backlash / 2;
  double ahead = motors->rotor[fin] - motors->shaft[fin];
  bool engaged = fabs(ahead) >= gap;
  // A motor that has just reversed has left the fin.
  motors->speed[fin] = engaged && ahead * motors->rotor_speed[fin] >= 0 ? motors->rotor_speed[fin] : 0;
  motors->shaft[fin] += engaged ? ahead - copysign(gap, ahead) : 0;
}

// Returns the current that the motor draws.
static double turn(struct motors *motors, unsigned fin, double drive_max) {
  const struct wiring *wiring = motors->wiring;
  int number = wiring->bridge[fin];
  const struct drv8830 *bridge = &motors->bridges[number == NOT_CONNECTED ? 0 : number];
  bool coasts = number == NOT_CONNECTED || drv8830_coasts(bridge);
  double drive = coasts ? 0 : wiring->leads[fin] * fmax(fmin(drv8830_drive(bridge), drive_max), -drive_max);
  double before = motors->rotor_speed[fin];
  double after = speed_after(before, friction(motors, before), motors->speed[fin],
                             motors->surroundings->fin_load, drive, coasts);
  motors->rotor_speed[fin] = after;
  motors->rotor[fin] += MOTORS_PERIOD * (before + after) / 2;
  turn_fin(motors, fin);
  return current(motors, drive, after);
}

// Evenly from -1 to 1.
static double random_share(struct motors *motors) {
  motors->noise ^= motors->noise << 13;
  motors->noise ^= motors->noise >> 17;
  motors->noise ^= motors->noise << 5;
  return motors->noise / 2147483648.0 - 1;
}

static void show(struct motors *motors, unsigned number) {
  const struct wiring *wiring = motors->wiring;
  int fin = wiring->shaft[number];
  if (fin == NOT_CONNECTED || isnan(motors->surroundings->encoder_error[number])) {
    return;
  }
  double error = motors->surroundings->encoder_error[number];
  double ticks = (motors->shaft[fin] + rotation_sign[fin] * error) * AS5040_TICKS / (2 * M_PI);
  double noise = wiring->encoder_noise ? wiring->encoder_noise * random_share(motors) : 0;
  as5040_turn(&motors->encoders[number],
              wiring->counting[number] * (encoder_zero[fin] + ENCODER_SIGN * ticks) + noise);
}

void motors_step(struct motors *motors) {
  double amperes = 0;
  double drive_max = motors_battery(motors) / VOLTS_PER_STEP;
  motors->steps++;
  for (unsigned fin = 0; fin < FIN_COUNT; fin++) {
    amperes += turn(motors, fin, drive_max);
  }
  motors->current = amperes;
  for (unsigned number = 0; number < FIN_COUNT; number++) {
    show(motors, number);
    motors->encoders[number].ready = motors->steps >= READY_STEPS;
  }
}

void motors_create(struct motors *motors, const struct drv8830 bridges[FIN_COUNT],
                   struct as5040 encoders[FIN_COUNT], const struct surroundings *surroundings,
                   const struct wiring *wiring) {
  *motors = (struct motors){
      .bridges = bridges, .encoders = encoders, .surroundings = surroundings, .wiring = wiring, .noise = 1};
  for (unsigned fin = 0; fin < FIN_COUNT; fin++) {
    motors->rotor[fin] = motors->shaft[fin] = rotation_sign[fin] * first_angle[fin];
    show(motors, fin);
  }
}

void motors_turn_by_hand(struct motors *motors, unsigned fin, double angle) {
  motors->rotor[fin] = motors->shaft[fin] = rotation_sign[fin] * angle;
  motors->rotor_speed[fin] = motors->speed[fin] = 0;
}

double motors_fin_angle(const struct motors *motors, unsigned fin) {
  return remainder(rotation_sign[fin] * motors->shaft[fin], 2 * M_PI);
}

double motors_fin_speed(const struct motors *motors, unsigned fin) {
  return rotation_sign[fin] * motors->speed[fin] + 0.0;  // and never -0
}
