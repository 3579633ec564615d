#include "fins/drv8830.h"

#include "board/board.h"

namespace mucat {
namespace {

constexpr uint8_t kAddresses[kFinCount] = {0x64, 0x60, 0x61, 0x63};

constexpr uint8_t kControl = 0x00;
constexpr uint8_t kForward = 1 << 0;
constexpr uint8_t kReverse = 1 << 1;
constexpr uint8_t kVoltageMin = 6;

constexpr uint8_t kFault = 0x01;
constexpr uint8_t kAnyFault = 1 << 0;
constexpr uint8_t kClear = 1 << 7;

}  // namespace

bool drive_bridge(uint8_t fin, int8_t drive) {
  const uint8_t voltage = drive < 0 ? -drive : drive;
  const uint8_t control = voltage < kVoltageMin ? 0 : voltage << 2 | (drive < 0 ? kReverse : kForward);
  const uint8_t message[] = {kControl, control};
  return board::exchange_i2c(kAddresses[fin], message, sizeof message, nullptr, 0);
}

bool bridge_failed(uint8_t fin) {
  uint8_t fault;
  if (!board::exchange_i2c(kAddresses[fin], &kFault, 1, &fault, 1)) return true;
  if (!(fault & kAnyFault)) return false;
  const uint8_t clear[] = {kFault, kClear};
  board::exchange_i2c(kAddresses[fin], clear, sizeof clear, nullptr, 0);
  return true;
}

}  // namespace mucat
