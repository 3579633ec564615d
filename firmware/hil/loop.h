// The simulated sensor readings of a board in the loop.
#pragma once
#include "packets.gen.h"

namespace mucat {
namespace loop {

// The newest reading; zeros before the first.
const Sense& newest_input();
// Detects new readings, tick by tick.
class Listener {
 public:
  // Call every tick. True if a new reading has come.
  bool step();
  // No reading for 250 ms, or none ever.
  bool lost() const { return quiet_ >= kLostTicks; }

 private:
  static constexpr uint8_t kLostTicks = 25;

  uint8_t seen_ = 0;
  uint8_t quiet_ = kLostTicks;
};

}  // namespace loop
}  // namespace mucat
