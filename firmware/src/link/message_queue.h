// Reliable messages that are not acknowledged yet; the only store of messages in flight.
#pragma once
#include <stdint.h>

#include "link/frame.h"
#include "packets.gen.h"

// The longest frames' worth of messages. The robot's few events need two; a sketch that is to fill the line
// needs four: set -DMUCAT_QUEUE_FRAMES=4.
#ifndef MUCAT_QUEUE_FRAMES
#define MUCAT_QUEUE_FRAMES 2
#endif

namespace mucat {

class MessageQueue {
 public:
  static constexpr uint8_t kBytes = MUCAT_QUEUE_FRAMES * kReliableMessagesBytesMax;

  // False if there is no room; then nothing of the message is stored.
  bool push(uint8_t type, const void* payload, uint8_t payload_size);
  // Copies the message at `offset` bytes after the oldest, its type first. Returns its bytes, or 0 if there
  // is none. The message stays until drop().
  uint8_t peek(uint8_t offset, uint8_t (&message)[kReliableBytesMax]) const;
  // True if more than `bytes` are stored, or the longest message has no room.
  bool more_than(uint8_t bytes) const { return used_ > bytes || kBytes - used_ <= kReliableBytesMax; }
  // Removes the oldest `bytes`, which are whole messages.
  void drop(uint8_t bytes);

 private:
  uint8_t at(uint8_t offset) const;
  void put(uint8_t byte);

  uint8_t bytes_[kBytes] = {};
  uint8_t head_ = 0;
  uint8_t used_ = 0;
};

}  // namespace mucat
