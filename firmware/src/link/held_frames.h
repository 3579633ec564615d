// Reliable frames that came before their turn, without their CRC.
#pragma once
#include <stdint.h>

#include "link/frame.h"

namespace mucat {

class HeldFrames {
 public:
  // Keeps the frame that was received, where there is room, and it is not there yet.
  void keep(const FrameDecoder& frame);
  // Gives the frame of that number back to the decoder and forgets it; false where it is not there.
  bool take(uint8_t number, FrameDecoder* frame);
  void forget(uint8_t number);
  void clear() { used_ = 0; }
  bool any() const { return used_ > 0; }
  // A bit for each of those after `expected`, the one that is missing.
  uint8_t after(uint8_t expected) const;

 private:
  // What RAM there is beside the stack: two of the longest frames and a short one, or six short ones.
  static constexpr uint8_t kBytes = 158;

  uint8_t find(uint8_t number) const;

  uint8_t bytes_[kBytes];  // each frame's size, and the frame
  uint8_t used_ = 0;
};

}  // namespace mucat
