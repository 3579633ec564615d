#include "fins/mixer.h"

#include <math.h>

namespace mucat {
namespace {

// Place of a fin, and direction of its push when it points along its mount; signs in body axes.
struct FinMount {
  int8_t forward;       // 1 at the front
  int8_t right;         // 1 on the right
  int8_t pushes_right;  // the push has a part to the right
  int8_t turns_right;   // the push turns the robot to the right: the sign of its moment about the down axis
};

constexpr FinMount kMounts[kFinCount] = {
    {1, 1, -1, -1},
    {-1, 1, -1, 1},
    {-1, -1, 1, -1},
    {1, -1, 1, 1},
};

// The part of `command` that a fin whose push has this sign can give without turning round.
float share(int8_t command, int8_t sign) {
  const int16_t demand = static_cast<int16_t>(command) * sign;
  return demand > 0 ? demand : 0;
}

}  // namespace

void mix(const Navigation& command, float amplitude, FinDemand (&demands)[kFinCount]) {
  constexpr float kFull = 127.0f;
  float along[kFinCount];
  float down[kFinCount];
  float length[kFinCount];
  float largest = kFull;
  for (uint8_t i = 0; i < kFinCount; ++i) {
    const FinMount& mount = kMounts[i];
    along[i] = share(command.x, mount.forward) + share(command.y, mount.pushes_right) +
               static_cast<float>(command.yaw) * mount.turns_right;
    down[i] = static_cast<float>(command.z) + static_cast<float>(command.roll) * mount.right -
              static_cast<float>(command.pitch) * mount.forward;
    length[i] = sqrtf(along[i] * along[i] + down[i] * down[i]);
    if (length[i] > largest) largest = length[i];
  }
  for (uint8_t i = 0; i < kFinCount; ++i) {
    demands[i].amplitude = amplitude * length[i] / largest;
    if (length[i] > 0) demands[i].direction = atan2f(-down[i], along[i]);
  }
}

}  // namespace mucat
