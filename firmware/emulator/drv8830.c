// SPDX-License-Identifier: GPL-3.0-or-later
#include "drv8830.h"

#define REGISTER_CONTROL 0
#define CONTROL_IN1 1
#define CONTROL_IN2 2
#define VSET_SHIFT 2
#define VSET_MIN 6  // 0.48 V; the data sheet reserves what is less
#define REGISTER_FAULT 1
#define FAULT_BITS 0x03  // any fault, overcurrent
#define FAULT_CLEAR 0x80

static bool idle(const struct drv8830 *bridge) {
  return !*bridge->powered || bridge->fault == FAULT_ABSENT || bridge->fault == FAULT_TRIPPED;
}

bool drv8830_coasts(const struct drv8830 *bridge) {
  unsigned inputs = bridge->control & (CONTROL_IN1 | CONTROL_IN2);
  bool brakes = inputs == (CONTROL_IN1 | CONTROL_IN2);
  return idle(bridge) || !(brakes || drv8830_drive(bridge));
}

int drv8830_drive(const struct drv8830 *bridge) {
  int steps = bridge->control >> VSET_SHIFT;
  if (idle(bridge) || steps < VSET_MIN) {
    return 0;
  }
  switch (bridge->control & (CONTROL_IN1 | CONTROL_IN2)) {
    case CONTROL_IN1:
      return steps;
    case CONTROL_IN2:
      return -steps;
    default:
      return 0;
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
  } else if (index == 1 && bridge->pointer == REGISTER_FAULT && byte & FAULT_CLEAR &&
             bridge->fault == FAULT_TRIPPED) {
    bridge->fault = FAULT_NONE;
  }
}

uint8_t drv8830_read(void *device) {
  const struct drv8830 *bridge = device;
  if (bridge->pointer == REGISTER_CONTROL) {
    return bridge->control;
  }
  return bridge->pointer == REGISTER_FAULT && bridge->fault == FAULT_TRIPPED ? FAULT_BITS : 0;
}
