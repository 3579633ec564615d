// Battery and beacon detectors with the simulator's values; no leak sensor.
#include "board/board.h"
#include "loop.h"

namespace mucat {
namespace board {
namespace {

// mV at full scale, as in sensors/battery.cpp.
constexpr uint32_t kFullScale = 10000;
constexpr uint16_t kCountsMax = 1023;

}  // namespace

void start_battery() {}

uint16_t take_battery() {
  return loop::newest_input().battery * static_cast<uint32_t>(kCountsMax) / kFullScale;
}

bool beacon_right() { return loop::newest_input().right; }

bool beacon_left() { return loop::newest_input().left; }

bool leak() { return false; }

}  // namespace board
}  // namespace mucat
