// The robot's debug lines.
#include "board/board.h"
#include "robot.h"

namespace mucat {
namespace {

FlashText describe(ResetCause cause) {
  switch (cause) {
    case ResetCause::kPowerOn:
      return FLASH_TEXT("power on");
    case ResetCause::kExternal:
      return FLASH_TEXT("reset pin");
    case ResetCause::kBrownOut:
      return FLASH_TEXT("brown-out");
    case ResetCause::kWatchdog:
      return FLASH_TEXT("watchdog: the main loop hung");
    case ResetCause::kUnknown:
      break;
  }
  return FLASH_TEXT("unknown reset");
}

FlashText describe(SensorFault device) {
  switch (device) {
    case SensorFault::kImu:
      return FLASH_TEXT("IMU");
    case SensorFault::kPressure:
      return FLASH_TEXT("pressure sensor");
    case SensorFault::kFinFrontRight:
      return FLASH_TEXT("fin front right");
    case SensorFault::kFinBackRight:
      return FLASH_TEXT("fin back right");
    case SensorFault::kFinBackLeft:
      return FLASH_TEXT("fin back left");
    case SensorFault::kFinFrontLeft:
      return FLASH_TEXT("fin front left");
  }
  return FLASH_TEXT("");
}

}  // namespace

void Robot::report_boot() {
  const ResetCause cause = board::reset_cause();
  const bool hung = cause == ResetCause::kWatchdog;
  DebugLine line(hung ? DebugLevel::kError : DebugLevel::kInfo);
  link_.queue_line(line << FLASH_TEXT("boot ") << epoch_ << FLASH_TEXT(", ") << describe(cause));
}

void Robot::report_disarmed(Disarming reason) {
  if (reason == Disarming::kNone) return;
  link_.queue_line(DebugLine(DebugLevel::kInfo) << FLASH_TEXT("disarmed: ") << mucat::describe(reason));
}

// Reports every device the first time, later those whose fault has changed.
void Robot::report_changed_faults() {
  const uint8_t now = faults();
  for (uint8_t device = 1; device <= static_cast<uint8_t>(SensorFault::kFinFrontLeft); device <<= 1) {
    if (reported_devices_ && !((now ^ reported_faults_) & device)) continue;
    DebugLine line(now & device ? DebugLevel::kWarning : DebugLevel::kInfo);
    line << describe(static_cast<SensorFault>(device));
    link_.queue_line(line << (now & device ? FLASH_TEXT(": no sensible answer") : FLASH_TEXT(": found")));
  }
  reported_faults_ = now;
  reported_devices_ = true;
}

}  // namespace mucat
