#include "fins/fin_law.h"

#include <math.h>

namespace mucat {
namespace {

float limit(float value, float maximum) {
  return value > maximum ? maximum : value < -maximum ? -maximum : value;
}

}  // namespace

float wrap_angle(float angle) {
  while (angle >= kPi) angle -= 2 * kPi;
  while (angle < -kPi) angle += 2 * kPi;
  return angle;
}

void FinLaw::start(float angle) { now_ = {wrap_angle(angle), 0}; }

float FinLaw::step(const FinDemand& demand, uint16_t phase, float turn) {
  const float remaining = wrap_angle(demand.direction - now_.direction);
  now_.direction =
      fabsf(remaining) <= turn ? demand.direction : wrap_angle(now_.direction + limit(remaining, turn));
  now_.amplitude += limit(demand.amplitude - now_.amplitude, kAmplitudePerTick);
  // A full turn is 65536, which -32768 to 32767 covers once.
  const float angle = static_cast<int16_t>(phase) * (kPi / 32768.0f);
  return wrap_angle(now_.direction + now_.amplitude / 2 * sinf(angle));
}

}  // namespace mucat
