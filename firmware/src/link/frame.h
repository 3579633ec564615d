// Frames of the serial line, without I/O.
//
//   COBS( control | {type, payload}... | number, unreliable frames alone | CRC-32 ) 00
//
// The type of the first message decides if the frame is reliable; reliable and unreliable messages never
// share a frame, but ACKNOWLEDGE goes with either. control: the lower four bits are the number of the
// reliable frame that the sender expects next. The upper four are a reliable frame's own number, or the upper
// four of an unreliable frame's twelve-bit number. The CRC is little-endian, over everything before it,
// combined by exclusive or with the session's key, or with 0 in an open frame.
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "link/cobs.h"
#include "packets.gen.h"

namespace mucat {

constexpr uint8_t kCrcBytes = 4;
constexpr uint8_t kControlBytes = 1;
// Before stuffing: a frame without the COBS byte and the closing zero.
constexpr uint8_t kBlockBytesMax = kFrameBytesMax - kCobsOverhead - 1;
constexpr uint8_t kNumberBytes = 1;
constexpr uint8_t kMessagesBytesMax = kBlockBytesMax - kControlBytes - kNumberBytes - kCrcBytes;
// Of an unreliable frame, beside its messages.
constexpr uint16_t kFrameOverhead = kFrameBytesMax - kMessagesBytesMax;
// A reliable frame has no number byte.
constexpr uint8_t kReliableMessagesBytesMax = kMessagesBytesMax + kNumberBytes;
constexpr uint32_t kOpen = 0;

// The key of all frames between this run of the host and this boot of the board: both epochs, mixed by
// MurmurHash3's finaliser. Similar epochs differ in few bits, and bit errors must not turn one key into the
// other. A CRC is no good mixer: some bit errors have the same effect. Never kOpen: no boot has number 0.
uint32_t session_key(uint16_t host_epoch, uint16_t board_epoch);

// Bytes of the longest reliable message, its type included.
constexpr uint8_t kReliableBytesMax = 1 + sizeof(Debug);
// Offset of the text's length in a message with text.
constexpr uint8_t kTextSizeAt = 1 + offsetof(Debug, text_size);

// Bytes of a message, its type included; `text_size` is used if the type carries text. 0 if the type is
// unknown or the text too long.
uint8_t message_bytes(uint8_t type, uint8_t text_size);

struct Message {
  uint8_t type;
  uint8_t size;
  const uint8_t* payload;
};

// The packet in a message of its type.
template <typename Packet>
Packet unpack(const Message& message) {
  Packet packet;
  memcpy(&packet, message.payload, sizeof packet);
  return packet;
}

// Decodes frames byte by byte. A frame is valid if stuffing, CRC, and all messages' types and lengths are.
class FrameDecoder {
 public:
  // True if this byte completes a valid frame. Its messages stay until the next call.
  bool feed(uint8_t byte);
  // The frame's next message; false after the last.
  bool next(Message* message);
  // True if the frame has a message of this type.
  bool has(uint8_t type) const;
  // Replaces the last frame by one that was received before, without its CRC.
  void restore(const uint8_t* content, uint8_t size);
  // A reliable frame without its CRC: control byte and messages.
  const uint8_t* content() const { return block_; }
  uint8_t content_bytes() const { return messages_end_; }
  // A reliable frame's number.
  uint8_t number() const { return block_[0] >> 4; }
  uint8_t acknowledged() const { return block_[0] & 15; }
  bool reliable() const { return is_reliable(block_[kControlBytes]); }
  // True if the frame belongs to no session.
  bool open() const { return !keyed_; }
  // From now on frames with this key, and open ones, are valid.
  void set_key(uint32_t key) { key_ = key; }
  // Invalid frames since the start.
  uint16_t invalid() const { return invalid_; }

 private:
  bool accept();
  bool well_formed() const;

  uint8_t block_[kFrameBytesMax - 1] = {};
  uint8_t size_ = 0;
  bool oversized_ = false;
  bool keyed_ = false;
  uint32_t key_ = kOpen;
  uint8_t cursor_ = 0;
  uint8_t messages_end_ = 0;
  uint16_t invalid_ = 0;
};

// Packs messages into one frame.
class FramePacker {
 public:
  bool fits(uint8_t payload_size) const {
    const bool reliable = !empty() && is_reliable(block_[kControlBytes]);
    return bytes_ + payload_size < (reliable ? kReliableMessagesBytesMax : kMessagesBytesMax);
  }
  // Call it only if the message fits.
  void add(uint8_t type, const void* payload, uint8_t payload_size);
  bool empty() const { return bytes_ == 0; }
  // Maximum bytes on the line of the frame that close() will write.
  uint8_t line_bytes() const { return kControlBytes + bytes_ + kNumberBytes + kCrcBytes + kCobsOverhead + 1; }
  // Writes the whole frame, closing zero included, and starts the next; returns its size.
  uint8_t close(uint16_t number, uint8_t acknowledged, uint32_t key, uint8_t (&frame)[kFrameBytesMax]);
  // Drops the messages and starts the next frame.
  void clear() { bytes_ = 0; }

 private:
  uint8_t block_[kBlockBytesMax] = {};
  uint8_t bytes_ = 0;  // of messages
};

}  // namespace mucat
