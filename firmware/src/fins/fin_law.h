// How a fin flaps: wanted angle = direction + amplitude / 2 · sin(2π · frequency · t + phase).
#pragma once
#include <stdint.h>

#include "fins/mixer.h"

namespace mucat {

constexpr float kPi = 3.14159265f;
constexpr float kTickSeconds = 0.01f;
constexpr float kFlapFrequency = 1.3f;
// A whole turn is 65536, so that the phase wraps by itself.
constexpr uint16_t kPhasePerTick = static_cast<uint16_t>(kFlapFrequency * kTickSeconds * 65536.0f + 0.5f);
constexpr uint16_t kFinPhase[kFinCount] = {0x8000, 0, 0, 0x8000};

// 80 encoder counts of 1024 in 0.1 s.
constexpr float kDirectionPerTick = 80.0f / 1024.0f * 2.0f * kPi / 10.0f;
// From full flapping to rest in 120 ms: fins that begin to stop 250 ms after the last command rest by 500 ms.
constexpr float kAmplitudePerTick = kAmplitudeMax / 12.0f;

// The angle's equal in -π to π.
float wrap_angle(float angle);

// One fin's law; its direction and amplitude follow what is demanded no faster than the limits above.
class FinLaw {
 public:
  // Starts at rest at this angle.
  void start(float angle);
  // Moves one tick on; returns the wanted angle, within -π to π.
  float step(const FinDemand& demand, uint16_t phase);
  bool flapping() const { return now_.amplitude > 0; }
  // About which it flaps now (rad).
  float direction() const { return now_.direction; }

 private:
  FinDemand now_ = {0, 0};
};

}  // namespace mucat
