#include "fins/mixer.h"

#include <math.h>

namespace mucat {
namespace {

// A fin pushes one way without turning round.
int16_t share(int16_t command) { return command > 0 ? command : 0; }

}  // namespace

void mix(const Navigation& command, float amplitude, FinDemand (&demands)[kFinCount]) {
  constexpr float kFull = 127.0f;
  float along[kFinCount];
  float down[kFinCount];
  float length[kFinCount];
  float largest = kFull;
  for (uint8_t i = 0; i < kFinCount; ++i) {
    const bool front = at_front(i);
    const bool right = on_right(i);
    // Along its mount a fin pushes inwards; a front right or a back left one turns the robot to the left by
    // it.
    const int16_t forwards = front ? command.x : -command.x;
    const int16_t inwards = right ? -command.y : command.y;
    const int16_t turn = front == right ? -command.yaw : command.yaw;
    const int16_t tilt = (right ? command.roll : -command.roll) - (front ? command.pitch : -command.pitch);
    along[i] = share(forwards) + share(inwards) + turn;
    down[i] = command.z + tilt;
    length[i] = sqrtf(along[i] * along[i] + down[i] * down[i]);
    if (length[i] > largest) largest = length[i];
  }
  for (uint8_t i = 0; i < kFinCount; ++i) {
    demands[i].amplitude = amplitude * length[i] / largest;
    if (length[i] > 0) demands[i].direction = atan2f(-down[i], along[i]);
  }
}

}  // namespace mucat
