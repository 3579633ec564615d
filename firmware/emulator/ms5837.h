// SPDX-License-Identifier: GPL-3.0-or-later
// TE Connectivity MS5837-30BA: pressure and temperature of the water, on I2C. It returns the raw
// conversions from which the data sheet's compensation gives pressure and temperature at the sensor.
#ifndef MS5837_H
#define MS5837_H

#include <stdbool.h>
#include <stdint.h>

#include "device_clock.h"
#include "surroundings.h"

#define MS5837_PROM_WORDS 7

struct ms5837 {
  struct device_clock clock;
  const struct surroundings *surroundings;
  uint16_t prom[MS5837_PROM_WORDS];
  bool was_reset;  // since power-on
  uint8_t command;
  unsigned read_index;
  double ready;  // s, end of its reset or conversion
  uint32_t conversion;
  uint32_t pressure, temperature;  // the last conversions
  enum fault fault;
};

void ms5837_create(struct ms5837 *sensor, struct device_clock clock, const struct surroundings *surroundings);
bool ms5837_start(void *sensor);
void ms5837_write(void *sensor, unsigned index, uint8_t byte);
uint8_t ms5837_read(void *sensor);

#endif
