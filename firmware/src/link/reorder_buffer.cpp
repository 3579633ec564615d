#include "link/reorder_buffer.h"

#include <string.h>

namespace mucat {

void ReorderBuffer::insert(const FrameDecoder& frame) {
  const uint8_t size = frame.content_bytes();
  if (find(frame.number()) < used_ || size >= kBytes - used_) return;
  bytes_[used_] = size;
  memcpy(bytes_ + used_ + 1, frame.content(), size);
  used_ += 1 + size;
}

bool ReorderBuffer::take(uint8_t number, FrameDecoder* frame) {
  const uint8_t at = find(number);
  if (at == used_) return false;
  frame->restore(bytes_ + at + 1, bytes_[at]);
  forget(number);
  return true;
}

void ReorderBuffer::forget(uint8_t number) {
  const uint8_t at = find(number);
  if (at == used_) return;
  const uint8_t size = 1 + bytes_[at];
  used_ -= size;
  memmove(bytes_ + at, bytes_ + at + size, used_ - at);
}

uint8_t ReorderBuffer::after(uint8_t expected) const {
  uint8_t bits = 0;
  for (uint8_t at = 0; at < used_; at += 1 + bytes_[at]) {
    bits |= 1 << (((bytes_[at + 1] >> 4) - expected - 1) & 15);
  }
  return bits;
}

uint8_t ReorderBuffer::find(uint8_t number) const {
  uint8_t at = 0;
  while (at < used_ && bytes_[at + 1] >> 4 != number) at += 1 + bytes_[at];
  return at;
}

}  // namespace mucat
