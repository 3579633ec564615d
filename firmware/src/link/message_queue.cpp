#include "link/message_queue.h"

namespace mucat {

static_assert(MessageQueue::kBytes >= 10 * (1 + sizeof(BoardEvent)), "too small for the events of a start");

uint8_t MessageQueue::at(uint8_t offset) const {
  const uint16_t index = head_ + offset;
  return bytes_[index < kBytes ? index : index - kBytes];
}

void MessageQueue::put(uint8_t byte) {
  const uint16_t index = head_ + used_;
  bytes_[index < kBytes ? index : index - kBytes] = byte;
  ++used_;
}

bool MessageQueue::push(uint8_t type, const void* payload, uint8_t payload_size) {
  if (payload_size >= kBytes - used_) return false;
  put(type);
  const uint8_t* const from = static_cast<const uint8_t*>(payload);
  for (uint8_t i = 0; i < payload_size; ++i) put(from[i]);
  return true;
}

uint8_t MessageQueue::peek(uint8_t offset, uint8_t (&message)[kReliableBytesMax]) const {
  if (offset >= used_) return 0;
  const uint8_t type = at(offset);
  // Other messages may be shorter, and nothing may follow.
  const uint8_t size = message_bytes(type, type == Debug::kType ? at(offset + kTextSizeAt) : 0);
  for (uint8_t i = 0; i < size; ++i) message[i] = at(offset + i);
  return size;
}

void MessageQueue::drop(uint8_t bytes) {
  const uint16_t head = head_ + bytes;
  head_ = head < kBytes ? head : head - kBytes;
  used_ -= bytes;
}

}  // namespace mucat
