#include "fins/drive_watch.h"

namespace mucat {
namespace {

// A sound motor turns against a new drive for as long as it needs to stop, some 50 ms.
constexpr int8_t kAgainstDrive = 12;
constexpr int16_t kAgainstCounts = 3;
constexpr uint8_t kAgainstTicks = 10;

// A fin whose shaft's seal is stiff may rest at any drive below this one. At this one it turns, by 2 counts a
// tick or more, once its motor has sped up and crossed the backlash of its gear.
constexpr int8_t kInVainDrive = 20;
constexpr int16_t kInVainCounts = 1;
constexpr uint8_t kInVainTicks = 15;

}  // namespace

void DriveWatch::restart() {
  against_ticks_ = 0;
  in_vain_ticks_ = 0;
  failed_ = false;
}

void DriveWatch::step(int8_t drive, int16_t turned) {
  const int8_t size = drive < 0 ? -drive : drive;
  const int16_t along = drive < 0 ? -turned : turned;
  against_ticks_ = size >= kAgainstDrive && along <= -kAgainstCounts ? against_ticks_ + 1 : 0;
  const bool turns = along > kInVainCounts || along < -kInVainCounts;
  in_vain_ticks_ = size >= kInVainDrive && !turns ? in_vain_ticks_ + 1 : 0;
  if (against_ticks_ >= kAgainstTicks || in_vain_ticks_ >= kInVainTicks) failed_ = true;
}

}  // namespace mucat
