// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpu6050.h"

#include <math.h>
#include <string.h>

#define REGISTER_RATE_DIVIDER 0x19
#define REGISTER_CONFIG 0x1a
#define REGISTER_GYRO_CONFIG 0x1b
#define REGISTER_ACCEL_CONFIG 0x1c
#define REGISTER_FORCE 0x3b
#define REGISTER_TEMPERATURE 0x41
#define REGISTER_RATE 0x43
#define REGISTER_POWER 0x6b
#define REGISTER_WHO_AM_I 0x75

#define POWER_RESET 0x80
#define POWER_SLEEP 0x40
#define POWER_CLOCK 0x01
#define FILTER_MASK 7
#define RANGE_SHIFT 3

// The data sheet's, of waking; and of samples, without and with the filter.
#define GYRO_START 30e-3    // s
#define FAST_PERIOD 125e-6  // s
#define SLOW_PERIOD 1e-3    // s

// Hz, bandwidth of the gyroscope by CONFIG; the accelerometer's is the same but for 1 Hz. The wider filters,
// up to CONFIG 3, are that of the simulated water.
#define NARROW_FILTER 4
static const double narrow_bandwidth[] = {20, 10, 5};

#define GRAVITY 9.80665
#define GYRO_CALIBRATED 25.0  // °C, at which its offset is what it is said to be
#define DEGREE (M_PI / 180)

// Counts for 1 °/s, 1 g and 1 °C, as in the data sheet; each range is half as fine as the one before it.
#define RATE_COUNTS 131.072
#define FORCE_COUNTS 16384.0
#define TEMPERATURE_COUNTS 340.0
#define TEMPERATURE_ZERO 36.53

static void put(struct mpu6050 *imu, unsigned address, double counts) {
  int value = (int)lround(fmin(fmax(counts, INT16_MIN), INT16_MAX));
  imu->registers[address] = (uint8_t)(value >> 8);
  imu->registers[address + 1] = (uint8_t)value;
}

static double range(const struct mpu6050 *imu, unsigned address) {
  return 1 << (imu->registers[address] >> RANGE_SHIFT & 3);
}

static double now(const struct mpu6050 *imu) { return imu->clock.seconds(imu->clock.owner); }

// The data sheets' values: an MPU-6500 (0x70) or MPU-9250 (0x71) is awake, an MPU-6050 and its copies sleep.
static void reset(struct mpu6050 *imu) {
  uint8_t identity = imu->wiring->imu_identity;
  bool awake = identity == 0x70 || identity == 0x71;
  memset(imu->registers, 0, sizeof imu->registers);
  imu->registers[REGISTER_POWER] = awake ? POWER_CLOCK : POWER_SLEEP;
  imu->woken = awake ? now(imu) : 0;
  imu->sample = -1;
}

static double pass(double before, double after, double share) { return share * after + (1 - share) * before; }

// A low-pass of first order, for the time in which the surroundings have been as they are.
void mpu6050_filter(struct mpu6050 *imu) {
  unsigned config = imu->registers[REGISTER_CONFIG] & FILTER_MASK;
  bool narrow = config >= NARROW_FILTER && config < FILTER_MASK && imu->sample >= 0;
  double seconds = now(imu) - imu->filtered;
  double share = narrow ? 1 - exp(-2 * M_PI * narrow_bandwidth[config - NARROW_FILTER] * seconds) : 1;
  for (unsigned i = 0; i < 3; i++) {
    imu->force[i] = pass(imu->force[i], imu->surroundings->force[i], share);
    imu->rate[i] = pass(imu->rate[i], imu->surroundings->rate[i], share);
  }
  imu->filtered = now(imu);
}

static void measure(struct mpu6050 *imu) {
  bool turning = now(imu) - imu->woken >= GYRO_START;
  double force_counts = FORCE_COUNTS / range(imu, REGISTER_ACCEL_CONFIG) / GRAVITY;
  double rate_counts = RATE_COUNTS / range(imu, REGISTER_GYRO_CONFIG) / DEGREE;
  double warmer = imu->surroundings->temperature - GYRO_CALIBRATED;
  for (unsigned i = 0; i < 3; i++) {
    struct chip_axis axis = imu->wiring->imu_axes[i];
    double offset = imu->wiring->gyro_offset[i] + imu->wiring->gyro_drift[i] * warmer;
    double rate = axis.sign * imu->rate[axis.body] + offset;
    put(imu, REGISTER_FORCE + 2 * i, axis.sign * imu->force[axis.body] * force_counts);
    put(imu, REGISTER_RATE + 2 * i, turning ? rate * rate_counts : 0);
  }
  put(imu, REGISTER_TEMPERATURE, (imu->surroundings->temperature - TEMPERATURE_ZERO) * TEMPERATURE_COUNTS);
}

// Measures if a sample is due since the last transfer.
static void sample(struct mpu6050 *imu) {
  unsigned config = imu->registers[REGISTER_CONFIG] & FILTER_MASK;
  double clock = config == 0 || config == FILTER_MASK ? FAST_PERIOD : SLOW_PERIOD;
  double number = floor((now(imu) - imu->woken) / (clock * (1 + imu->registers[REGISTER_RATE_DIVIDER])));
  if (number != imu->sample) {
    mpu6050_filter(imu);
    imu->sample = number;
    measure(imu);
  }
}

void mpu6050_create(struct mpu6050 *imu, struct device_clock clock, const struct surroundings *surroundings,
                    const struct wiring *wiring) {
  *imu = (struct mpu6050){.clock = clock, .surroundings = surroundings, .wiring = wiring};
  reset(imu);
}

void mpu6050_dip(struct mpu6050 *imu) { reset(imu); }

// A transfer reads one whole sample.
bool mpu6050_start(void *device) {
  struct mpu6050 *imu = device;
  bool awake = !(imu->registers[REGISTER_POWER] & POWER_SLEEP);
  if (awake && imu->fault == FAULT_NONE) {
    sample(imu);
  }
  return imu->fault != FAULT_ABSENT;
}

static bool writable(unsigned address) {
  return address < REGISTER_FORCE || (address > 0x60 && address != REGISTER_WHO_AM_I);
}

void mpu6050_write(void *device, unsigned index, uint8_t byte) {
  struct mpu6050 *imu = device;
  if (index == 0) {
    imu->pointer = byte % MPU6050_REGISTERS;
    return;
  }
  bool power = imu->pointer == REGISTER_POWER;
  if (power && imu->registers[REGISTER_POWER] & ~byte & POWER_SLEEP) {
    imu->woken = now(imu);
    imu->sample = -1;
  }
  if (power && byte & POWER_RESET) {
    reset(imu);
  } else if (writable(imu->pointer)) {
    imu->registers[imu->pointer] = byte;
  }
  imu->pointer = (imu->pointer + 1) % MPU6050_REGISTERS;
}

uint8_t mpu6050_read(void *device) {
  struct mpu6050 *imu = device;
  bool identity = imu->pointer == REGISTER_WHO_AM_I;
  uint8_t byte = identity ? imu->wiring->imu_identity : imu->registers[imu->pointer];
  imu->pointer = (imu->pointer + 1) % MPU6050_REGISTERS;
  return byte;
}
