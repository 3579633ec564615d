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
// Pa: 5 and 10 cm of water. A cell of EEPROM lasts for 100,000 writes, so that waves must not cause them.
constexpr int32_t kAtSurface = 500;
constexpr int32_t kSubmerged = 1000;

bool plausible(int32_t pressure) { return pressure >= kSurfaceMin && pressure <= kSurfaceMax; }

}  // namespace

void Surface::start() {
  next_byte_ = sizeof(Record);
  const board::RetainedMemory& retained = board::retained_memory();
  if (retained.complement == ~retained.value) restore(retained.value);
  Record record;
  board::read_eeprom(board::kSurfaceAt, &record, sizeof record);
  recorded_ = record.complement == static_cast<uint16_t>(~record.value);
  if (known() || !recorded_) return;
  restore(2 * static_cast<int32_t>(record.value));
  uncertain_ = known();
}

void Surface::restore(int32_t pressure) {
  if (!plausible(pressure)) return;
  pressure_ = pressure;
  readings_ = kReadings;
}

void Surface::add(int32_t pressure) {
  if (known() || !plausible(pressure)) return;
  pressure_ += pressure;
  if (++readings_ < kReadings) return;
  pressure_ /= kReadings;
  retain();
  // EEPROM may hold the one before it.
  set_recorded(false);
}

void Surface::retain() {
  board::RetainedMemory& retained = board::retained_memory();
  retained.value = pressure_;
  retained.complement = ~static_cast<uint32_t>(pressure_);
  uncertain_ = false;
}

void Surface::step(int32_t pressure, bool armed) {
  if (!known()) return;
  const int32_t below = pressure - pressure_;
  const bool at_surface = below > -kAtSurface && below < kAtSurface;
  // What EEPROM restored outlives the next reset, too.
  if (at_surface && uncertain_) retain();
  const bool recorded = armed || below >= kSubmerged || (recorded_ && !at_surface);
  if (recorded != recorded_) set_recorded(recorded);
  if (next_byte_ == sizeof(Record)) return;
  const uint16_t value = pressure_ / 2;
  const Record record = {value, recorded_ ? static_cast<uint16_t>(~value) : value};
  board::write_eeprom(board::kSurfaceAt + next_byte_, reinterpret_cast<const uint8_t*>(&record)[next_byte_]);
  ++next_byte_;
}

void Surface::set_recorded(bool recorded) {
  recorded_ = recorded;
  next_byte_ = 0;
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
