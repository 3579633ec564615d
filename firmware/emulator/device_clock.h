// SPDX-License-Identifier: GPL-3.0-or-later
// The time that a device keeps which takes some for what it does, in s.
#ifndef DEVICE_CLOCK_H
#define DEVICE_CLOCK_H

struct device_clock {
  double (*seconds)(const void *owner);
  const void *owner;
};

#endif
