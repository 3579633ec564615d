// The flapping of a fin: set point = direction + amplitude / 2 · sin(2π · frequency · t + phase).
#pragma once
#include <stdint.h>

#include "fins/mixer.h"

namespace mucat {

constexpr float kPi = 3.14159265f;
constexpr float kTickSeconds = 0.01f;
// The front fins flap against the back fins.
inline uint16_t fin_phase(uint8_t fin) { return at_front(fin) ? 0x8000 : 0; }

// The largest stroke fades to rest in 120 ms: fins that begin to stop 250 ms after the last command rest by
// 500 ms, for all parameter values.
constexpr float kAmplitudePerTick = 1.6f / 12.0f;

// Change of the phase in a tick. A full turn is 65536, so the phase wraps by itself.
inline uint16_t phase_per_tick(float frequency) { return frequency * kTickSeconds * 65536.0f + 0.5f; }

// The same angle within -π to π.
float wrap_angle(float angle);

// The law of one fin; its direction and amplitude follow the demand at a limited rate.
class FinLaw {
 public:
  // Starts at rest at this angle.
  void start(float angle);
  // One tick: the direction changes by at most `turn`. Returns the set point, within -π to π.
  float step(const FinDemand& demand, uint16_t phase, float turn);
  bool flapping() const { return now_.amplitude > 0; }
  // The direction about which it flaps now (rad).
  float direction() const { return now_.direction; }

 private:
  FinDemand now_ = {0, 0};
};

}  // namespace mucat
