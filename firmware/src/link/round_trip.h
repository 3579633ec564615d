// How long to wait for an acknowledgement (RFC 6298, in milliseconds and whole numbers): the smoothed round
// trip and four times its deviation, capped and never doubled, and what the bytes in flight need on the line.
#pragma once
#include <stdint.h>

namespace mucat {

class RoundTrip {
 public:
  void measure(uint16_t ms);
  uint16_t timeout(uint16_t bytes_in_flight) const;

 private:
  uint16_t mean_ = 0;       // ms / 8
  uint16_t deviation_ = 0;  // ms / 4
  bool measured_ = false;
};

}  // namespace mucat
