// SPDX-License-Identifier: GPL-3.0-or-later
#include "ms5837.h"

#include <math.h>

#define COMMAND_ADC_READ 0x00
#define COMMAND_RESET 0x1e
#define COMMAND_PRESSURE 0x40
#define COMMAND_TEMPERATURE 0x50
#define COMMAND_PROM 0xa0

#define CONVERSION_MAX 0xffffffu
#define OVERSAMPLING_STEPS 6
#define RESET_SECONDS 2.8e-3
#define PASCALS 10.0  // the data sheet counts in 0.1 mbar

// The data sheet's example of a sensor: C1 to C6 follow the word with the checksum.
static const uint16_t calibration[MS5837_PROM_WORDS] = {0, 34982, 36352, 20328, 22354, 26646, 26146};

// Maximum times of the data sheet for OSR 256, 512 and so on to 8192.
static const double conversion_seconds[OVERSAMPLING_STEPS] = {0.60e-3, 1.17e-3, 2.28e-3,
                                                              4.54e-3, 9.04e-3, 18.08e-3};

struct compensation {
  double temperature;  // 0.01 °C
  double offset, sensitivity;
};

// The data sheet's checksum, CRC-4 with the polynomial x^4 + x + 1 over the words and a zero word.
static unsigned crc4(const uint16_t prom[MS5837_PROM_WORDS]) {
  uint16_t remainder = 0;
  for (unsigned i = 0; i < 2 * (MS5837_PROM_WORDS + 1); i++) {
    uint16_t word = i / 2 < MS5837_PROM_WORDS ? prom[i / 2] : 0;
    word = i < 2 ? word & 0x0fff : word;
    remainder ^= i % 2 ? word & 0xff : word >> 8;
    for (int bit = 0; bit < 8; bit++) {
      remainder = (uint16_t)(remainder << 1 ^ (remainder & 0x8000 ? 0x3000 : 0));
    }
  }
  return remainder >> 12;
}

// First and second order compensation for a raw temperature.
static struct compensation compensate(const uint16_t c[MS5837_PROM_WORDS], double raw) {
  double difference = raw - c[5] * 0x1p8;
  double temperature = 2000 + difference * c[6] * 0x1p-23;
  double offset = c[2] * 0x1p16 + c[4] * difference * 0x1p-7;
  double sensitivity = c[1] * 0x1p15 + c[3] * difference * 0x1p-8;
  double off = temperature - 2000, cold = temperature + 1500;
  if (temperature >= 2000) {
    return (struct compensation){temperature - 2 * difference * difference * 0x1p-37, offset - off * off / 16,
                                 sensitivity};
  }
  struct compensation low = {temperature - 3 * difference * difference * 0x1p-33, offset - 3 * off * off / 2,
                             sensitivity - 5 * off * off / 8};
  if (temperature < -1500) {
    low.offset -= 7 * cold * cold;
    low.sensitivity -= 4 * cold * cold;
  }
  return low;
}

// Bisection: the compensated temperature grows with the raw one.
static uint32_t raw_temperature(const struct ms5837 *sensor) {
  double target = sensor->surroundings->temperature * 100;
  uint32_t low = 0, high = CONVERSION_MAX;
  while (low < high) {
    uint32_t middle = low + (high - low) / 2;
    if (compensate(sensor->prom, middle).temperature < target) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

static uint32_t raw_pressure(const struct ms5837 *sensor) {
  struct compensation found = compensate(sensor->prom, raw_temperature(sensor));
  double counts = sensor->surroundings->pressure / PASCALS;
  double raw = (counts * 0x1p13 + found.offset) * 0x1p21 / found.sensitivity;
  return (uint32_t)lround(fmin(fmax(raw, 0), CONVERSION_MAX));
}

static double now(const struct ms5837 *sensor) { return sensor->clock.seconds(sensor->clock.owner); }

void ms5837_create(struct ms5837 *sensor, struct device_clock clock,
                   const struct surroundings *surroundings) {
  *sensor = (struct ms5837){.clock = clock, .surroundings = surroundings};
  for (unsigned i = 0; i < MS5837_PROM_WORDS; i++) {
    sensor->prom[i] = calibration[i];
  }
  sensor->prom[0] |= (uint16_t)(crc4(sensor->prom) << 12);
}

bool ms5837_start(void *device) {
  struct ms5837 *sensor = device;
  sensor->read_index = 0;
  return sensor->fault != FAULT_ABSENT;
}

static void convert(struct ms5837 *sensor, uint8_t command) {
  unsigned step = (command & 0x0f) / 2u;
  if (step >= OVERSAMPLING_STEPS) {
    return;
  }
  bool pressure = (command & 0xf0) == COMMAND_PRESSURE;
  uint32_t *last = pressure ? &sensor->pressure : &sensor->temperature;
  if (sensor->fault != FAULT_STUCK) {
    *last = pressure ? raw_pressure(sensor) : raw_temperature(sensor);
  }
  sensor->conversion = *last;
  sensor->ready = now(sensor) + conversion_seconds[step];
}

void ms5837_write(void *device, unsigned index, uint8_t byte) {
  struct ms5837 *sensor = device;
  if (index > 0) {
    return;
  }
  sensor->command = byte;
  if (byte == COMMAND_ADC_READ && now(sensor) < sensor->ready) {
    sensor->conversion /= 2;  // read too early, it goes on, and its result is wrong
  } else if (byte == COMMAND_RESET) {
    sensor->was_reset = true;
    sensor->conversion = 0;
    sensor->ready = now(sensor) + RESET_SECONDS;
  } else if ((byte & 0xf0) == COMMAND_PRESSURE || (byte & 0xf0) == COMMAND_TEMPERATURE) {
    convert(sensor, byte);
  }
}

// Reads 0 before a reset or conversion is done, and without a request. After power-on only a reset loads the
// PROM.
uint8_t ms5837_read(void *device) {
  struct ms5837 *sensor = device;
  unsigned index = sensor->read_index++;
  if (now(sensor) < sensor->ready) {
    return 0;
  }
  if (sensor->command == COMMAND_ADC_READ && index < 3) {
    uint8_t byte = (uint8_t)(sensor->conversion >> (16 - 8 * index));
    sensor->conversion = index == 2 ? 0 : sensor->conversion;  // a conversion is read once
    return byte;
  }
  if (!sensor->was_reset || sensor->command < COMMAND_PROM || index >= 2) {
    return 0;
  }
  unsigned word = (sensor->command - COMMAND_PROM) / 2u;
  return word < MS5837_PROM_WORDS ? (uint8_t)(sensor->prom[word] >> (8 - 8 * index)) : 0;
}
