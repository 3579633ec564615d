#include "sensors/depth.h"

#include "board/board.h"

namespace mucat {
namespace {

// Pa per m: fresh water of 1000 kg/m³, 9.81 m/s².
constexpr int32_t kPressurePerMetre = 9810;
// Pa: range of air pressure, from a high mountain to a strong high.
constexpr int32_t kSurfaceMin = 50000;
constexpr int32_t kSurfaceMax = 120000;
// Pa: 32 m, the limit of a depth of 16 bits.
constexpr int32_t kAboveMax = 32 * kPressurePerMetre;

bool plausible(int32_t pressure) { return pressure >= kSurfaceMin && pressure <= kSurfaceMax; }

}  // namespace

void Surface::start() {
  const board::RetainedMemory& retained = board::retained_memory();
  const int32_t pressure = static_cast<int32_t>(retained.value);
  if (retained.complement != ~retained.value || !plausible(pressure)) return;
  pressure_ = pressure;
  readings_ = kReadings;
}

void Surface::add(int32_t pressure) {
  if (known() || !plausible(pressure)) return;
  pressure_ += pressure;
  if (++readings_ < kReadings) return;
  pressure_ /= kReadings;
  board::retained_memory().value = pressure_;
  board::retained_memory().complement = ~static_cast<uint32_t>(pressure_);
}

int16_t Surface::depth(int32_t pressure) const {
  const int32_t above = pressure - pressure_;
  if (above >= kAboveMax) return INT16_MAX;
  if (above <= -kAboveMax) return INT16_MIN;
  const int32_t half = kPressurePerMetre / 2;
  return (above * 1000 + (above < 0 ? -half : half)) / kPressurePerMetre;
}

}  // namespace mucat
