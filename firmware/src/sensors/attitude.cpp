#include "sensors/attitude.h"

#include <math.h>

namespace mucat {
namespace {

// 1/s: gravity corrects within about a second, much slower than the fins shake the hull (1.3 Hz).
constexpr float kGain = 1.0f;
// 1/s²: a steady offset of the gyroscope is found within about twenty seconds.
constexpr float kBiasGain = 0.05f;
// g: outside these the hull accelerates, and the force is not along gravity.
constexpr float kForceMin = 0.7f;
constexpr float kForceMax = 1.3f;

}  // namespace

void Attitude::update(const float (&rate)[3], const float (&force)[3], float seconds) {
  const float length = sqrtf(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
  float corrected[3];
  for (int axis = 0; axis < 3; ++axis) corrected[axis] = rate[axis] - bias_[axis];
  if (length > kForceMin && length < kForceMax) {
    // Specific force is acceleration minus gravity: at rest it points up.
    const float down[3] = {-force[0] / length, -force[1] / length, -force[2] / length};
    if (!levelled_) level(down);
    const float w = q_[0], x = q_[1], y = q_[2], z = q_[3];
    const float estimated[3] = {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z};
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      const float error = down[next] * estimated[last] - down[last] * estimated[next];
      bias_[axis] -= kBiasGain * error * seconds;
      corrected[axis] += kGain * error;
    }
  }
  turn(corrected, seconds);
}

// Sets roll and pitch from gravity at once, yaw 0: the shortest turn that brings `down` onto the world's
// down.
void Attitude::level(const float (&down)[3]) {
  levelled_ = true;
  const float w = 1 + down[2];
  // Upside down there is no shortest turn; it takes a roll of 180°.
  const float found[4] = {w, down[1], -down[0], 0};
  const float length = sqrtf(w * w + found[1] * found[1] + found[2] * found[2]);
  for (int i = 0; i < 4; ++i) q_[i] = length > 1e-3f ? found[i] / length : i == 1;
}

void Attitude::turn(const float (&rate)[3], float seconds) {
  const float half = seconds / 2;
  const float x = rate[0] * half, y = rate[1] * half, z = rate[2] * half;
  const float turned[4] = {
      q_[0] - q_[1] * x - q_[2] * y - q_[3] * z,
      q_[1] + q_[0] * x + q_[2] * z - q_[3] * y,
      q_[2] + q_[0] * y - q_[1] * z + q_[3] * x,
      q_[3] + q_[0] * z + q_[1] * y - q_[2] * x,
  };
  float squared = 0;
  for (float part : turned) squared += part * part;
  const float scale = 1 / sqrtf(squared);
  for (int i = 0; i < 4; ++i) q_[i] = turned[i] * scale;
}

}  // namespace mucat
