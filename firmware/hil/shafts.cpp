// Four motors with encoders in the chip's memory, in place of the drivers of H-bridges and encoders. Their
// law is that of the emulated board (firmware/emulator/motors.c): the speed follows the drive with a time
// constant.
#include <math.h>

#include "fins/drv8830.h"
#include "fins/fin_law.h"
#include "fins/position_loop.h"
#include "sensors/as5040.h"

namespace mucat {
namespace {

constexpr float kSpeedPerStep = 0.315f;    // rad/s for a step of the bridge's voltage
constexpr float kTimeConstant = 0.03f;     // s
constexpr float kDecayPerTick = 0.71653f;  // exp(-kTickSeconds / kTimeConstant)
constexpr int8_t kDriveMin = 6;            // as for the H-bridge
constexpr float kCountsPerRadian = kCountsPerTurn / (2 * kPi);

struct Shaft {
  float angle;
  float speed;
  int8_t drive;
};
Shaft shafts[kFinCount];

}  // namespace

bool drive_bridge(uint8_t fin, int8_t drive) {
  shafts[fin].drive = drive > -kDriveMin && drive < kDriveMin ? 0 : drive;
  return true;
}

bool bridge_failed(uint8_t) { return false; }

// Called once a tick for each encoder: moves its shaft by one tick.
MagneticField read_encoder_counts(uint8_t fin, int16_t* counts) {
  Shaft& shaft = shafts[fin];
  const float driven = kSpeedPerStep * shaft.drive;
  const float behind = shaft.speed - driven;
  shaft.angle =
      wrap_angle(shaft.angle + driven * kTickSeconds + behind * kTimeConstant * (1 - kDecayPerTick));
  shaft.speed = driven + behind * kDecayPerTick;
  *counts = lroundf(shaft.angle * kCountsPerRadian) & (kCountsPerTurn - 1);
  return MagneticField::kGreen;
}

}  // namespace mucat
