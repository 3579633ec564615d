// A line that damages frames in one chosen way, and the count of frames that a decoder accepts.
//
// One frame at a time is damaged. A whole one follows, which shows that the decoder still accepts frames. An
// accepted frame must be one that was sent: the same session, number, acknowledgement and messages, in the
// order of sending and at most once. Any other accepted frame is an undetected corruption. Damage between
// frames, such as a zero before one, leaves the frame whole: it may be accepted and does not count as
// corrupted. Frames of other sessions were never sent in this one.
#pragma once
#include <stdint.h>

#include <random>
#include <vector>

#include "link/frame.h"

namespace mucat {
namespace host {

enum class Damage : uint8_t {
  kBitErrors,         // independent, at a rate, and at least one in the frame
  kBurst,             // 2 to 64 bits, of which half are wrong; may reach into the next frame
  kDeleted,           // 1 to 3 bytes
  kInserted,          // 1 to 3 bytes, of any value
  kDoubled,           // 1 to 3 bytes
  kMoved,             // a byte deleted, another inserted elsewhere: the length stays
  kTruncated,         // only the frame's beginning, or only its end
  kJoined,            // the beginning of one frame and the end of the next
  kGarbage,           // random bytes
  kWrongChecksum,     // a frame with the checksum of another
  kOtherSession,      // a whole frame of another session, mostly a neighbouring one
  kOtherSessionBits,  // the same with 1 to 4 wrong bits
};

struct Counts {
  uint32_t corrupted;   // frames that were not whole when they arrived
  uint32_t accepted;    // accepted frames that were sent
  uint32_t undetected;  // accepted frames that were never sent
};

class Corruption {
 public:
  // `rate` is used for bit errors only.
  Corruption(Damage damage, double rate, uint64_t seed);
  // Makes the next batch, with at least this many damaged frames.
  void carry(uint32_t frames);
  // Reads the batch with the chip's decoder.
  Counts read() const;

  const std::vector<uint8_t>& line() const { return line_; }
  // The batch's frames as they were sent, one after the other, closing zeros included.
  const std::vector<uint8_t>& sent() const { return sent_bytes_; }
  // For each sent frame, 1 if it was damaged.
  const std::vector<uint8_t>& damaged() const { return damaged_; }
  // Damaged frames that were never sent in this session.
  uint32_t foreign() const { return foreign_; }
  uint32_t key() const { return key_; }

 private:
  using Bytes = std::vector<uint8_t>;

  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  bool chance(uint32_t one_in) { return below(one_in) == 0; }
  double uniform();
  Bytes frame(uint32_t key);
  Bytes open_frame();
  uint32_t neighbour();
  void send(const Bytes& frame, bool damaged);
  void put(const Bytes& bytes);
  void send_foreign(Bytes bytes);
  void flip_some(Bytes* bytes);
  void damage_one();
  void bit_errors();
  void burst();
  void damage_bytes();
  void truncate();
  void join();
  void garbage();
  void wrong_checksum();

  Damage damage_;
  double rate_;
  std::mt19937_64 random_;
  uint16_t host_epoch_;
  uint16_t board_epoch_;
  uint32_t key_;
  Bytes line_;
  Bytes sent_bytes_;
  Bytes damaged_;
  uint32_t damaged_frames_ = 0;
  uint32_t foreign_ = 0;
};

}  // namespace host
}  // namespace mucat
