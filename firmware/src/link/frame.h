// Frames of the serial line, without I/O.
//
//   COBS( control | {type, payload}... | number, unreliable frames alone | CRC-32 ) 00
//
// The first message says whether the frame is reliable: all of a kind travel together. control: in the lower
// four bits the number of the reliable frame that the sender waits for; in the upper four a reliable frame's
// own number, or the upper four of the twelve bits that number an unreliable one. The CRC is little-endian,
// over all before it, combined by exclusive or with the session's key, or with nothing in an open frame.
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "link/cobs.h"
#include "packets.gen.h"

namespace mucat {

constexpr uint8_t kCrcBytes = 4;
constexpr uint8_t kControlBytes = 1;
// Before stuffing: what is left of a frame without COBS's byte and the closing zero.
constexpr uint8_t kBlockBytesMax = kFrameBytesMax - kCobsOverhead - 1;
constexpr uint8_t kNumberBytes = 1;
constexpr uint8_t kMessagesBytesMax = kBlockBytesMax - kControlBytes - kNumberBytes - kCrcBytes;
// A reliable frame has no number byte.
constexpr uint8_t kReliableMessagesBytesMax = kMessagesBytesMax + kNumberBytes;
constexpr uint32_t kOpen = 0;

// The key of the frames between this run of the host and this boot of the board: both epochs, mixed by
// MurmurHash3's finaliser. Like epochs differ in few bits, and bit errors must not make up for it; mixing by
// a CRC would not do, as some bit errors have the same effect. Never kOpen, as no boot is numbered 0.
uint32_t session_key(uint16_t host_epoch, uint16_t board_epoch);

// Bytes of the longest reliable message, its type included.
constexpr uint8_t kReliableBytesMax = 1 + sizeof(Debug);
// Where in a message that carries text the text's length stands.
constexpr uint8_t kTextSizeAt = 1 + offsetof(Debug, text_size);

// Bytes of a message, its type included; `text_size` is of use where it carries text. 0 where the type is
// unknown, or the text longer than it may be.
uint8_t message_bytes(uint8_t type, uint8_t text_size);

struct Message {
  uint8_t type;
  uint8_t size;
  const uint8_t* payload;
};

// Only of a message of this type.
template <typename Packet>
Packet unpack(const Message& message) {
  Packet packet;
  memcpy(&packet, message.payload, sizeof packet);
  return packet;
}

// Takes bytes one by one; a frame counts only as a whole: stuffing, CRC, and every message's type and length.
class FrameDecoder {
 public:
  // True where this byte completes a valid frame. Its messages stand until the next call.
  bool feed(uint8_t byte);
  // The frame's next message; false after the last.
  bool next(Message* message);
  // Whether the frame has a message of this type.
  bool has(uint8_t type) const;
  // Takes a frame that was received before, without its CRC, in place of the last one.
  void put_back(const uint8_t* content, uint8_t size);
  // The frame without its CRC: control byte and messages, where it is reliable.
  const uint8_t* content() const { return block_; }
  uint8_t content_bytes() const { return messages_end_; }
  // A reliable frame's number.
  uint8_t number() const { return block_[0] >> 4; }
  uint8_t acknowledged() const { return block_[0] & 15; }
  bool reliable() const { return is_reliable(block_[kControlBytes]); }
  // Whether the frame belongs to no session.
  bool open() const { return open_; }
  // Frames with this key, and open ones, are valid from now on.
  void set_key(uint32_t key) { key_ = key; }
  // Frames thrown away since the start.
  uint16_t invalid() const { return invalid_; }

 private:
  bool accept();
  bool well_formed() const;

  uint8_t block_[kFrameBytesMax - 1];
  uint8_t size_ = 0;
  bool oversized_ = false;
  bool open_ = true;
  uint32_t key_ = kOpen;
  uint8_t cursor_ = 0;
  uint8_t messages_end_ = 0;
  uint16_t invalid_ = 0;
};

// Gathers messages into one frame.
class FramePacker {
 public:
  bool fits(uint8_t payload_size) const {
    const bool reliable = !empty() && is_reliable(block_[kControlBytes]);
    return size_ + payload_size < kControlBytes + (reliable ? kReliableMessagesBytesMax : kMessagesBytesMax);
  }
  // Only where it fits.
  void add(uint8_t type, const void* payload, uint8_t payload_size);
  bool empty() const { return size_ == kControlBytes; }
  // Bytes on the line that close() will make of it, at most.
  uint8_t line_bytes() const { return size_ + kNumberBytes + kCrcBytes + kCobsOverhead + 1; }
  // Writes the whole frame, closing zero included, and starts the next; returns its size.
  uint8_t close(uint16_t number, uint8_t acknowledged, uint32_t key, uint8_t (&frame)[kFrameBytesMax]);
  // Starts the next without the messages gathered.
  void clear() { size_ = kControlBytes; }

 private:
  uint8_t block_[kBlockBytesMax];
  uint8_t size_ = kControlBytes;
};

}  // namespace mucat
