// The robot's events, which the host puts into words (robot_runtime/contract/board_events.py).
#include "board/board.h"
#include "robot.h"

namespace mucat {
namespace {

// Bits of DeviceFault: one more than the number of the last.
constexpr uint8_t kFaultCount = 17;
static_assert(static_cast<uint32_t>(DeviceFault::kLeak) == 1UL << (kFaultCount - 1), "the bits moved");

}  // namespace

void Robot::report_boot() {
  link_.queue_event(BoardEventKind::kBoot, static_cast<uint8_t>(board::reset_cause()), epoch_);
}

void Robot::report_disarmed(Disarming reason) {
  if (reason == Disarming::kNone) return;
  link_.queue_event(BoardEventKind::kDisarmed, static_cast<uint8_t>(reason));
}

// Reports sensors and encoders the first time, later those whose fault has changed.
void Robot::report_changed_faults() {
  const uint32_t now = faults();
  const uint32_t always = static_cast<uint32_t>(DeviceFault::kBridgeFrontRight) - 1;
  uint32_t changed = (now ^ reported_faults_) | (reported_devices_ ? 0 : always);
  uint32_t there = now;
  for (uint8_t number = 0; number < kFaultCount; ++number, changed >>= 1, there >>= 1) {
    if (!(changed & 1)) continue;
    link_.queue_event(there & 1 ? BoardEventKind::kFault : BoardEventKind::kFaultOver, number,
                      sensors_.imu_identity());
  }
  reported_faults_ = now;
  reported_devices_ = true;
}

}  // namespace mucat
