// What a board in the loop knows of the simulated water.
#pragma once
#include "packets.gen.h"

namespace mucat {
namespace loop {

// The newest word; zeros before the first.
const Sense& sense();
// Follows the words at the pace of ticks.
class Listener {
 public:
  // Call every tick. True where there is a word that it has not seen.
  bool step();
  // No word for 250 ms, or none ever.
  bool lost() const { return quiet_ >= kLostTicks; }

 private:
  static constexpr uint8_t kLostTicks = 25;

  uint8_t seen_ = 0;
  uint8_t quiet_ = kLostTicks;
};

}  // namespace loop
}  // namespace mucat
