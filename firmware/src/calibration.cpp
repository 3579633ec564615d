#include "calibration.h"

#include <stddef.h>
#include <string.h>

#include "board/board.h"
#include "link/crc32.h"
#include "sensors/simulated_input.h"

namespace mucat {
namespace {

constexpr uint8_t kAllSteps = 0x7F;
static_assert(static_cast<uint8_t>(CalibrationStep::kBeacons) == (kAllSteps + 1) / 2, "the steps changed");

constexpr uint16_t kFactorUnit = 10000;
// Further off, no regulator and no divider is sound, and a factor of 0 would hide a flat battery.
constexpr uint16_t kFactorMin = 8000;
constexpr uint16_t kFactorMax = 12500;

uint8_t magnitude(int8_t axis) { return axis < 0 ? -axis : axis; }

bool possible(const Calibration& calibration) {
  uint8_t axes = 0;
  bool mirrored = false;
  uint8_t before = magnitude(calibration.axes[2]);
  for (int8_t axis : calibration.axes) {
    if (axis < -3 || axis > 3) return false;
    const uint8_t number = magnitude(axis);
    axes |= 1 << number;
    // Each reversed axis mirrors. Of the axes in the wrong cyclic order all three are out of place.
    mirrored ^= axis < 0;
    mirrored ^= number != before % 3 + 1;
    before = number;
  }
  return axes == 0xE && !mirrored && calibration.battery_factor >= kFactorMin &&
         calibration.battery_factor <= kFactorMax;
}

}  // namespace

uint32_t CalibrationStore::checksum() const {
  return crc32(reinterpret_cast<const uint8_t*>(&record_), offsetof(Record, checksum));
}

void CalibrationStore::start() {
  static_assert(sizeof(Record) <= board::kSurfaceAt, "it would overwrite the surface");
  board::read_eeprom(0, &record_, sizeof record_);
  const bool valid = record_.version == kCalibrationVersion && record_.checksum == checksum();
  if (valid && possible(value()) && !in_the_loop()) return;
  Calibration& none = record_.calibration;
  memset(&none, 0, sizeof none);
  for (uint8_t axis = 0; axis < 3; ++axis) none.axes[axis] = axis + 1;
  none.battery_factor = kFactorUnit;
  if (in_the_loop()) none.done = kAllSteps;
}

uint8_t CalibrationStore::missing() const { return writing_ ? kAllSteps : kAllSteps & ~value().done; }

void CalibrationStore::store(const Calibration& calibration) {
  answer_due_ = true;
  if (in_the_loop() || !possible(calibration)) return;
  record_.version = kCalibrationVersion;
  record_.calibration = calibration;
  record_.checksum = checksum();
  writing_ = true;
  next_byte_ = 0;
}

void CalibrationStore::step() {
  if (!writing_) return;
  if (next_byte_ == sizeof record_) {
    writing_ = false;
    start();
    return;
  }
  board::write_eeprom(next_byte_, reinterpret_cast<const uint8_t*>(&record_)[next_byte_]);
  ++next_byte_;
}

}  // namespace mucat
