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

constexpr uint8_t kFirstFin = 2;  // the number of the first bit of DeviceFault that belongs to a fin
constexpr uint8_t kMagnet = kFirstFin + 3 * kFinCount;
constexpr uint8_t kSurface = kMagnet + 1;
constexpr uint8_t kFaultCount = kSurface + 1;
static_assert(static_cast<uint16_t>(DeviceFault::kMagnet) == 1 << kMagnet, "the bits moved");
static_assert(static_cast<uint16_t>(DeviceFault::kSurface) == 1U << kSurface, "the bits moved");

FlashText describe_fin(uint8_t fin) {
  switch (fin) {
    case 0:
      return FLASH_TEXT("front right");
    case 1:
      return FLASH_TEXT("back right");
    case 2:
      return FLASH_TEXT("back left");
    default:
      return FLASH_TEXT("front left");
  }
}

// Adds the device of a bit's number, and what it does now.
void describe(uint8_t number, bool failed, DebugLine* line) {
  if (number == kMagnet) {
    *line << (failed ? FLASH_TEXT("encoders: a magnet out of place")
                     : FLASH_TEXT("encoders: magnets in place"));
    return;
  }
  if (number == kSurface) {
    *line << (failed ? FLASH_TEXT("depth uncertain: supply failed below")
                     : FLASH_TEXT("depth certain again"));
    return;
  }
  const uint8_t kind = (number - kFirstFin) / kFinCount;
  const bool bridge = number >= kFirstFin && kind == 1;
  const bool tracking = number >= kFirstFin && kind == 2;
  if (number == 0) *line << FLASH_TEXT("IMU");
  if (number == 1) *line << FLASH_TEXT("pressure sensor");
  if (number >= kFirstFin) {
    *line << (tracking ? FLASH_TEXT("fin ") : bridge ? FLASH_TEXT("H-bridge ") : FLASH_TEXT("encoder "));
    *line << describe_fin((number - kFirstFin) % kFinCount);
  }
  if (!failed) {
    *line << (tracking ? FLASH_TEXT(": follows") : FLASH_TEXT(": ok"));
  } else if (tracking) {
    *line << FLASH_TEXT(": not following, stopped");
  } else {
    *line << (bridge ? FLASH_TEXT(": silent or tripped") : FLASH_TEXT(": no sensible answer"));
  }
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

// Reports sensors and encoders the first time, later those whose fault has changed.
void Robot::report_changed_faults() {
  const uint16_t now = faults();
  const uint16_t always = static_cast<uint16_t>(DeviceFault::kBridgeFrontRight) - 1;
  const uint16_t changed = (now ^ reported_faults_) | (reported_devices_ ? 0 : always);
  for (uint8_t number = 0; number < kFaultCount; ++number) {
    const uint16_t bit = 1 << number;
    if (!(changed & bit)) continue;
    DebugLine line(now & bit ? DebugLevel::kWarning : DebugLevel::kInfo);
    describe(number, now & bit, &line);
    // Another chip, with registers that agree or not.
    const uint8_t identity = sensors_.imu_identity();
    if (bit == static_cast<uint16_t>(DeviceFault::kImu) && identity && identity != kMpu6050) {
      (line << FLASH_TEXT(", WHO_AM_I 0x")).hex(identity);
    }
    link_.queue_line(line);
  }
  reported_faults_ = now;
  reported_devices_ = true;
}

}  // namespace mucat
