// The reliable messages that are not acknowledged yet: the only store of what is in flight.
#pragma once
#include <stdint.h>

#include "link/frame.h"
#include "packets.gen.h"

namespace mucat {

class MessageQueue {
 public:
  static constexpr uint8_t kBytes = 4 * kReliableMessagesBytesMax;

  // False where it has no room: nothing of the message is kept then.
  bool push(uint8_t type, const void* payload, uint8_t payload_size);
  // Copies the message that starts so many bytes behind the oldest, its type first; its bytes, or 0 where
  // there is none. It stays until drop().
  uint8_t peek(uint8_t offset, uint8_t (&message)[kReliableBytesMax]) const;
  // Whether there is more than so many bytes, or no room for the longest message.
  bool more_than(uint8_t bytes) const { return used_ > bytes || kBytes - used_ <= kReliableBytesMax; }
  // Forgets the oldest bytes, which are whole messages.
  void drop(uint8_t bytes);

 private:
  uint8_t at(uint8_t offset) const;
  void put(uint8_t byte);

  uint8_t bytes_[kBytes];
  uint8_t head_ = 0;
  uint8_t used_ = 0;
};

}  // namespace mucat
