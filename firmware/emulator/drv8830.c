// SPDX-License-Identifier: GPL-3.0-or-later
#include "drv8830.h"

#define REGISTER_CONTROL 0
#define CONTROL_IN1 1
#define CONTROL_IN2 2
#define VSET_SHIFT 2

int drv8830_drive(const struct drv8830 *bridge) {
  if (!*bridge->powered || bridge->fault == FAULT_ABSENT) {
    return 0;
  }
  int steps = (bridge->control >> VSET_SHIFT) * (bridge->fault == FAULT_REVERSED ? -1 : 1);
  switch (bridge->control & (CONTROL_IN1 | CONTROL_IN2)) {
    case CONTROL_IN1:
      return steps;
    case CONTROL_IN2:
      return -steps;
    default:
      return 0;  // coasting or braking
  }
}

bool drv8830_start(void *device) {
  struct drv8830 *bridge = device;
  return *bridge->powered && bridge->fault != FAULT_ABSENT;
}

void drv8830_write(void *device, unsigned index, uint8_t byte) {
  struct drv8830 *bridge = device;
  if (index == 0) {
    bridge->pointer = byte;
  } else if (index == 1 && bridge->pointer == REGISTER_CONTROL && bridge->fault != FAULT_STUCK) {
    bridge->control = byte;
  }
}

// The other register reports overcurrent and overheating, which are not emulated.
uint8_t drv8830_read(void *device) {
  const struct drv8830 *bridge = device;
  return bridge->pointer == REGISTER_CONTROL ? bridge->control : 0;
}
