// A line that harms every frame it carries in one chosen way, and the count of what a decoder believes of it.
//
// Harm comes upon one frame at a time; a whole one follows, which shows that the decoder still listens. What
// is believed must be a frame that was sent: the same session, number, acknowledgement and messages, in the
// order of sending and at most once. Anything else that is believed is an undetected corruption. Where harm
// falls between frames, as a zero put before one, the frame itself is whole: it may be believed, and does not
// count as corrupted. Frames of other sessions were never sent in this one.
#pragma once
#include <stdint.h>

#include <random>
#include <vector>

#include "link/frame.h"

namespace mucat {
namespace host {

enum class Harm : uint8_t {
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
  uint32_t believed;    // frames that were sent, and understood
  uint32_t undetected;  // frames that were understood, and never sent
};

class Corruption {
 public:
  // `rate` is that of bit errors, of which the other harms know nothing.
  Corruption(Harm harm, double rate, uint64_t seed);
  // Makes another stretch of line, with at least so many harmed frames.
  void carry(uint32_t frames);
  // Reads the stretch with the chip's decoder.
  Counts read() const;

  const std::vector<uint8_t>& line() const { return line_; }
  // The stretch's frames as they were sent, one after the other, closing zeros included.
  const std::vector<uint8_t>& sent() const { return sent_bytes_; }
  // For each of these whether it was harmed.
  const std::vector<uint8_t>& harmed() const { return harmed_; }
  // Harmed pieces of line that were never sent as frames of this session.
  uint32_t strangers() const { return strangers_; }
  uint32_t key() const { return key_; }

 private:
  using Bytes = std::vector<uint8_t>;

  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  bool chance(uint32_t one_in) { return below(one_in) == 0; }
  double share();
  Bytes frame(uint32_t key);
  Bytes open_frame();
  uint32_t neighbour();
  void send(const Bytes& frame, bool harmed);
  void put(const Bytes& bytes);
  void stranger(Bytes bytes);
  void flip_some(Bytes* bytes);
  void harm_one();
  void bit_errors();
  void burst();
  void harm_bytes();
  void truncate();
  void join();
  void garbage();
  void wrong_checksum();

  Harm harm_;
  double rate_;
  std::mt19937_64 random_;
  uint16_t host_epoch_;
  uint16_t board_epoch_;
  uint32_t key_;
  Bytes line_;
  Bytes sent_bytes_;
  Bytes harmed_;
  uint32_t harmed_frames_ = 0;
  uint32_t strangers_ = 0;
};

}  // namespace host
}  // namespace mucat
