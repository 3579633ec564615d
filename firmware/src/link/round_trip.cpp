#include "link/round_trip.h"

#include "link/baud.h"
#include "packets.gen.h"

namespace mucat {
namespace {

constexpr uint16_t airtime_ms(uint16_t bytes) { return bytes * 10000UL / kBaud; }

constexpr uint16_t kCapMs = 100 + airtime_ms(2 * kFrameBytesMax);
// The host may pause for long; the mean must not overflow.
constexpr uint16_t kLongestMs = 4000;

}  // namespace

void RoundTrip::measure(uint16_t ms) {
  if (ms > kLongestMs) ms = kLongestMs;
  if (!measured_) {
    measured_ = true;
    mean_ = ms << 3;
    deviation_ = ms << 1;
    return;
  }
  const int16_t error = static_cast<int16_t>(ms - (mean_ >> 3));
  mean_ += error;
  deviation_ += (error < 0 ? -error : error) - (deviation_ >> 2);
}

uint16_t RoundTrip::timeout(uint16_t bytes_in_flight) const {
  const uint16_t wait = measured_ ? (mean_ >> 3) + deviation_ : kCapMs;
  return (wait < kCapMs ? wait : kCapMs) + airtime_ms(bytes_in_flight);
}

uint16_t RoundTrip::stalled_timeout(uint16_t bytes_in_flight) const {
  const uint16_t wait = timeout(bytes_in_flight);
  const uint16_t trip = ((mean_ + (mean_ >> 1)) >> 3) + 1;
  return measured_ && trip < wait ? trip : wait;
}

}  // namespace mucat
