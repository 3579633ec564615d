#include "link/frame.h"

#include <string.h>

#include "link/crc32.h"

namespace mucat {
namespace {

uint32_t read_u32(const uint8_t* at) {
  uint32_t value;
  memcpy(&value, at, sizeof value);
  return value;
}

// Bytes of the message at `at`; 0 if its type is unknown or it does not fit.
uint8_t message_bytes_at(const uint8_t* at, uint8_t available) {
  const uint8_t bytes = message_bytes(at[0], available > kTextSizeAt ? at[kTextSizeAt] : 0);
  return bytes > available ? 0 : bytes;
}

}  // namespace

uint32_t session_key(uint16_t host_epoch, uint16_t board_epoch) {
  uint32_t key = static_cast<uint32_t>(host_epoch) << 16 | board_epoch;
  key = (key ^ key >> 16) * 0x85ebca6bUL;
  key = (key ^ key >> 13) * 0xc2b2ae35UL;
  return key ^ key >> 16;
}

uint8_t message_bytes(uint8_t type, uint8_t text_size) {
  if (type == Debug::kType) return text_size > Debug::kTextMax ? 0 : kTextSizeAt + 1 + text_size;
  return payload_bytes(type) + 1;
}

bool FrameDecoder::feed(uint8_t byte) {
  if (byte != 0) {
    if (size_ < sizeof block_) {
      block_[size_++] = byte;
    } else {
      oversized_ = true;
    }
    return false;
  }
  // Zeros in a row are not a frame: a sender may put one before a frame to end earlier noise.
  if (size_ == 0) return false;
  const bool valid = !oversized_ && accept();
  if (!valid) ++invalid_;
  size_ = 0;
  oversized_ = false;
  return valid;
}

bool FrameDecoder::accept() {
  const uint8_t size = decode_cobs(block_, size_);
  if (size <= kControlBytes + kCrcBytes) return false;
  messages_end_ = size - kCrcBytes;
  cursor_ = kControlBytes;
  const uint32_t key = crc32(block_, messages_end_) ^ read_u32(block_ + messages_end_);
  keyed_ = key != kOpen;
  if (keyed_ && key != key_) return false;
  if (!reliable()) messages_end_ -= kNumberBytes;
  return cursor_ < messages_end_ && well_formed();
}

bool FrameDecoder::well_formed() const {
  uint8_t at = kControlBytes;
  while (at < messages_end_) {
    const uint8_t bytes = message_bytes_at(block_ + at, messages_end_ - at);
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

bool FrameDecoder::next(Message* message) {
  if (cursor_ >= messages_end_) return false;
  const uint8_t* const at = block_ + cursor_;
  const uint8_t bytes = message_bytes_at(at, messages_end_ - cursor_);
  cursor_ += bytes;
  *message = Message{at[0], static_cast<uint8_t>(bytes - 1), at + 1};
  return true;
}

bool FrameDecoder::has(uint8_t type) const {
  for (uint8_t at = kControlBytes; at < messages_end_;
       at += message_bytes_at(block_ + at, messages_end_ - at)) {
    if (block_[at] == type) return true;
  }
  return false;
}

void FrameDecoder::restore(const uint8_t* content, uint8_t size) {
  memcpy(block_, content, size);
  messages_end_ = size;
  cursor_ = kControlBytes;
}

void FramePacker::add(uint8_t type, const void* payload, uint8_t payload_size) {
  uint8_t* const at = block_ + kControlBytes + bytes_;
  at[0] = type;
  memcpy(at + 1, payload, payload_size);
  bytes_ += 1 + payload_size;
}

uint8_t FramePacker::close(uint16_t number, uint8_t acknowledged, uint32_t key,
                           uint8_t (&frame)[kFrameBytesMax]) {
  uint8_t upper = number, size = kControlBytes + bytes_;
  if (!is_reliable(block_[kControlBytes])) {
    block_[size++] = number;
    upper = number >> 8;
  }
  block_[0] = static_cast<uint8_t>(upper << 4 | acknowledged);
  const uint32_t crc = crc32(block_, size) ^ key;
  memcpy(block_ + size, &crc, kCrcBytes);
  size = encode_cobs(block_, size + kCrcBytes, frame);
  frame[size] = 0;
  clear();
  return size + 1;
}

}  // namespace mucat
