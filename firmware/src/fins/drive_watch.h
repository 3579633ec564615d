// Watches a fin's motor for what no position loop can master.
#pragma once
#include <stdint.h>

namespace mucat {

// A motor whose leads or whose encoder are swapped turns against its drive, faster and faster. One that is
// jammed, too stiff or without supply does not turn, and one whose encoder stands still seems not to.
class DriveWatch {
 public:
  // Drives the fin again.
  void restart();
  // One tick: the drive of the last tick, and the counts by which the shaft has turned since, positive as
  // positive drive turns it.
  void step(int8_t drive, int16_t turned);
  // The fin must not be driven until restart().
  bool failed() const { return failed_; }

 private:
  uint8_t against_ticks_ = 0;
  uint8_t in_vain_ticks_ = 0;
  bool failed_ = false;
};

}  // namespace mucat
