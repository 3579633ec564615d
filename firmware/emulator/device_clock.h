// SPDX-License-Identifier: GPL-3.0-or-later
// Clock of a device whose operations take time, in s.
#ifndef DEVICE_CLOCK_H
#define DEVICE_CLOCK_H

struct device_clock {
  double (*seconds)(const void *owner);
  const void *owner;
};

#endif
