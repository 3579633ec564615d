// Attitude from turn rate and gravity.
//
// Mahony, Hamel, Pflimlin: Nonlinear complementary filters on the special orthogonal group, IEEE Transactions
// on Automatic Control 53(5), 2008, the passive filter with bias estimate. Body axes forward, right, down;
// world north, east, down. Gravity corrects roll and pitch; yaw is the integral of the rate alone.
#pragma once

namespace mucat {

class Attitude {
 public:
  // Level, heading north.
  void start() { q_[0] = 1; }
  // Rate in rad/s, specific force in g (level and at rest: 0, 0, -1), `seconds` since the last call.
  void update(const float (&rate)[3], const float (&force)[3], float seconds);
  // Unit quaternion w, x, y, z that turns body into world.
  const float (&quaternion() const)[4] { return q_; }

 private:
  void level(const float (&down)[3]);
  void turn(const float (&rate)[3], float seconds);

  float q_[4] = {};
  float bias_[3] = {};
  bool levelled_ = false;
};

}  // namespace mucat
