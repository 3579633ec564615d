// Reliable frames received out of order, without their CRC.
#pragma once
#include <stdint.h>

#include "link/frame.h"

namespace mucat {

class ReorderBuffer {
 public:
  // Stores the received frame if there is room and it is not stored yet.
  void insert(const FrameDecoder& frame);
  // Returns the frame of that number to the decoder and removes it; false if it is not stored.
  bool take(uint8_t number, FrameDecoder* frame);
  void forget(uint8_t number);
  void clear() { used_ = 0; }
  bool any() const { return used_ > 0; }
  // A bit for each stored frame after `expected`, the missing one.
  uint8_t after(uint8_t expected) const;

 private:
  // The RAM that the stack leaves: two of the longest frames and a short one, or six short ones.
  static constexpr uint8_t kBytes = 158;

  uint8_t find(uint8_t number) const;

  uint8_t bytes_[kBytes] = {};  // each frame's size, and the frame
  uint8_t used_ = 0;
};

}  // namespace mucat
