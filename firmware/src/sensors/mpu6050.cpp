#include "sensors/mpu6050.h"

#include "board/board.h"
#include "board/flash.h"

namespace mucat {
namespace {

constexpr uint8_t kAddress = 0x69;
constexpr uint8_t kFirstReading = 0x3B;
constexpr uint8_t kIdentityRegister = 0x75;

// WHO_AM_I of chips whose registers agree where they are used here: MPU-6050, MPU-6500, MPU-9250, and copies
// of the first that are sold under its name.
const uint8_t kIdentities[] PROGMEM = {kMpu6050, 0x70, 0x71, 0x72, 0x98};

constexpr uint8_t kRanges = 0x1B;
constexpr uint8_t kRange = 0x08;

struct Setting {
  uint8_t address;
  uint8_t value;
};
const Setting kSettings[] PROGMEM = {
    {0x6B, 0x01},           // PWR_MGMT_1: awake, clock from the gyroscope, more stable than the internal one
    {0x19, 0x00},           // SMPLRT_DIV: 1 kHz, so that a reading is at most 1 ms old
    {0x1A, 0x03},           // CONFIG: low-pass 44 Hz, below half of the 100 Hz at which it is read
    {kRanges, kRange},      // GYRO_CONFIG: ±500 °/s
    {kRanges + 1, kRange},  // ACCEL_CONFIG: ±4 g
};
// The MPU-6500's family filters its accelerometer by a register of its own, which is another's threshold
// here.
constexpr Setting kForceFilter = {0x1D, 0x03};

// Ticks: the gyroscope needs 30 ms to start after waking; a missing chip is tried again ten times a second.
constexpr uint8_t kSettle = 5;
constexpr uint8_t kRetry = 10;
constexpr uint8_t kCheck = 100;

bool known(uint8_t identity) {
  for (const uint8_t& one : kIdentities) {
    if (pgm_read_byte(&one) == identity) return true;
  }
  return false;
}

bool write(const Setting& setting) {
  const uint8_t message[] = {setting.address, setting.value};
  return board::exchange_i2c(kAddress, message, sizeof message, nullptr, 0);
}

int16_t big_endian(const uint8_t* at) { return static_cast<int16_t>(at[0] << 8 | at[1]); }

}  // namespace

bool Mpu6050::set_up() {
  identity_ = 0;
  if (!board::exchange_i2c(kAddress, &kIdentityRegister, 1, &identity_, 1) || !known(identity_)) return false;
  for (const Setting& setting : kSettings) {
    if (!write({pgm_read_byte(&setting.address), pgm_read_byte(&setting.value)})) return false;
  }
  return identity_ == kMpu6050 || write(kForceFilter);
}

// False if the chip has lost its ranges. After a dip of its supply the MPU-6500's family is awake, with
// others.
bool Mpu6050::check() {
  if (++unchecked_ < kCheck) return true;
  unchecked_ = 0;
  uint8_t ranges[2];
  return board::exchange_i2c(kAddress, &kRanges, 1, ranges, sizeof ranges) && ranges[0] == kRange &&
         ranges[1] == kRange;
}

bool Mpu6050::step(ImuReading* reading) {
  if (wait_) {
    --wait_;
    return false;
  }
  if (!ready_) {
    ready_ = set_up();
    // A chip that only answers the settings has given no reading yet.
    if (!ready_) faulty_ = true;
    wait_ = ready_ ? kSettle : kRetry;
    return false;
  }
  uint8_t bytes[14];
  const bool answers = board::exchange_i2c(kAddress, &kFirstReading, 1, bytes, sizeof bytes) && check();
  uint8_t any = 0;
  for (uint8_t byte : bytes) any |= byte;
  // After a dip of its supply the MPU-6050 sleeps, and answers zeros.
  if (!answers || !any) {
    ready_ = false;
    faulty_ = true;
    return false;
  }
  for (uint8_t axis = 0; axis < 3; ++axis) {
    reading->force[axis] = big_endian(bytes + 2 * axis);
    reading->rate[axis] = big_endian(bytes + 8 + 2 * axis);
  }
  faulty_ = false;
  return true;
}

}  // namespace mucat
