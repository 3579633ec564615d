// Turns a navigation command into a demand for each fin.
//
// A flapping fin pushes from tip to root: with its zero direction at 0 along its mount, at -90° down, at 90°
// up and at 180° against its mount. So each fin's share is a vector in the plane in which it turns: along its
// mount and down. The vector's direction is the fin's zero direction, its length the fin's amplitude.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

inline bool at_front(uint8_t fin) { return fin == 0 || fin == 3; }
inline bool on_right(uint8_t fin) { return fin < 2; }

struct FinDemand {
  float direction;  // rad, the angle about which the fin flaps
  float amplitude;  // rad, peak to peak
};

// `amplitude` belongs to a command of 1. A fin without demand keeps its direction, so that a zero command
// does not turn fins.
void mix(const Navigation& command, float amplitude, FinDemand (&demands)[kFinCount]);

}  // namespace mucat
