// How long to wait for an acknowledgement (RFC 6298, in milliseconds and whole numbers): the smoothed round
// trip and four times its deviation, capped and never doubled, and what the bytes in flight need on the line.
// The cap is 100 ms and the airtime of two of the host's longest frames: the one that is under way when ours
// arrives, and the one after it that acknowledges ours.
#pragma once
#include <stdint.h>

namespace mucat {

class RoundTrip {
 public:
  void measure(uint16_t ms);
  uint16_t timeout(uint16_t bytes_in_flight) const;
  // The same where the line would idle meanwhile: one and a half mean round trips.
  uint16_t stalled_timeout(uint16_t bytes_in_flight) const;

 private:
  uint16_t mean_ = 0;       // ms / 8
  uint16_t deviation_ = 0;  // ms / 4
  bool measured_ = false;
};

}  // namespace mucat
