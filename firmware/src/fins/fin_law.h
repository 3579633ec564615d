// How a fin flaps: set point = direction + amplitude / 2 · sin(2π · frequency · t + phase).
#pragma once
#include <stdint.h>

#include "fins/mixer.h"

namespace mucat {

constexpr float kPi = 3.14159265f;
constexpr float kTickSeconds = 0.01f;
constexpr uint16_t kFinPhase[kFinCount] = {0x8000, 0, 0, 0x8000};

// From the largest flapping to rest in 120 ms: fins that begin to stop 250 ms after the last command rest by
// 500 ms, whatever is tuned.
constexpr float kAmplitudePerTick = 1.6f / 12.0f;

// How far the phase moves in a tick. A whole turn is 65536, so that it wraps by itself.
inline uint16_t phase_per_tick(float frequency) { return frequency * kTickSeconds * 65536.0f + 0.5f; }

// The angle's equal in -π to π.
float wrap_angle(float angle);

// One fin's law; its direction and amplitude follow what is demanded no faster than they may.
class FinLaw {
 public:
  // Starts at rest at this angle.
  void start(float angle);
  // Moves one tick on, its direction by no more than `turn`; returns the set point, within -π to π.
  float step(const FinDemand& demand, uint16_t phase, float turn);
  bool flapping() const { return now_.amplitude > 0; }
  // About which it flaps now (rad).
  float direction() const { return now_.direction; }

 private:
  FinDemand now_ = {0, 0};
};

}  // namespace mucat
