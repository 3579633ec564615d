// The retransmit timeout (RFC 6298, in milliseconds and whole numbers): the smoothed round trip plus four
// times its deviation, capped and never doubled, plus the airtime of the bytes in flight. The cap is 100 ms
// plus the airtime of two of the host's longest frames: the one on the line when ours arrives, and the next
// one, which acknowledges ours.
#pragma once
#include <stdint.h>

namespace mucat {

class RoundTrip {
 public:
  void measure(uint16_t ms);
  uint16_t timeout(uint16_t bytes_in_flight) const;
  // The timeout if the line would otherwise be idle: one and a half mean round trips.
  uint16_t stalled_timeout(uint16_t bytes_in_flight) const;

 private:
  uint16_t mean_ = 0;       // ms / 8
  uint16_t deviation_ = 0;  // ms / 4
  bool measured_ = false;
};

}  // namespace mucat
