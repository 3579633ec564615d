#include "sensors/depth.h"

#include "board/board.h"

namespace mucat {
namespace {

// cm/s².
constexpr int32_t kGravity = 981;
// Pa: range of air pressure, from a high mountain to a strong high.
constexpr int32_t kSurfaceMin = 50000;
constexpr int32_t kSurfaceMax = 120000;
// m: the limit of a depth of 16 bits.
constexpr int32_t kDepthMax = 32;

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

void Surface::forget() {
  pressure_ = 0;
  readings_ = 0;
}

int16_t Surface::depth(int32_t pressure, uint16_t density) const {
  const int32_t above = pressure - pressure_;
  const int32_t per_metre = density * kGravity / 100;
  if (above >= kDepthMax * per_metre) return INT16_MAX;
  if (above <= -kDepthMax * per_metre) return INT16_MIN;
  const int32_t half = per_metre / 2;
  return (above * 1000 + (above < 0 ? -half : half)) / per_metre;
}

}  // namespace mucat
