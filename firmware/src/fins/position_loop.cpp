#include "fins/position_loop.h"

#include <math.h>

#include "fins/fin_law.h"

namespace mucat {
namespace {

// One drive step for each count that the error changed in a tick damps a motor that needs 30 ms to reach its
// speed, and drives a flapping fin ahead. Within the dead zone (1°) the drive is 0, so that the fin does not
// oscillate.
constexpr int16_t kDeadZone = 3;
// The H-bridge gives nothing below 6: a drive of 2 to 5 becomes 6, so that a fin does not stop short.
constexpr int16_t kDriveNone = 2;
constexpr int16_t kDriveMin = 6;

int16_t magnitude(int16_t value) { return value < 0 ? -value : value; }

}  // namespace

FinCalibration fin_calibration(const Calibration& calibration, uint8_t fin) {
  const uint8_t bit = 1 << fin;
  return {static_cast<int16_t>(calibration.fin_zeros[fin]),
          static_cast<int8_t>(calibration.encoders_reversed & bit ? -1 : 1),
          static_cast<int8_t>(calibration.motors_reversed & bit ? -1 : 1)};
}

int16_t wrap_counts(int16_t counts) {
  return static_cast<int16_t>(static_cast<uint16_t>(counts + kCountsPerTurn / 2) % kCountsPerTurn) -
         kCountsPerTurn / 2;
}

int16_t counts_from_angle(const FinCalibration& fin, float angle) {
  const int16_t turned = lroundf(angle * (kCountsPerTurn / (2 * kPi)));
  return fin.zero + fin.angle_sign * turned;
}

float angle_from_counts(const FinCalibration& fin, int16_t counts) {
  const int16_t turned = wrap_counts(fin.angle_sign * (counts - fin.zero));
  return turned * (2 * kPi / kCountsPerTurn);
}

int8_t PositionLoop::step(const FinCalibration& fin, int16_t set_point, int16_t measured, int16_t gain) {
  const int16_t error = fin.drive_sign * wrap_counts(set_point - measured);
  const int16_t change = stepped_ ? wrap_counts(error - last_error_) : 0;
  last_error_ = error;
  stepped_ = true;
  if (magnitude(error) <= kDeadZone) return 0;
  const int16_t drive =
      (static_cast<int32_t>(gain) * error + static_cast<int32_t>(change) * kGainUnit) / kGainUnit;
  const int16_t size = magnitude(drive);
  if (size < kDriveNone) return 0;
  const int16_t limited = size < kDriveMin ? kDriveMin : size > kDriveMax ? kDriveMax : size;
  return drive < 0 ? -limited : limited;
}

}  // namespace mucat
