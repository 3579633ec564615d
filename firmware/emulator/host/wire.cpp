// SPDX-License-Identifier: GPL-3.0-or-later
#include "wire.h"

#include <algorithm>

#include "link/baud.h"

namespace mucat {
namespace host {
namespace {

constexpr double kBitUs = 1e6 / kBaud;
constexpr double kCharacterUs = CHARACTER_BITS * kBitUs;

}  // namespace

void Wire::carry(double now, const Deliver& deliver) {
  while (!waiting.empty() && free + kCharacterUs <= now) {
    const uint8_t byte = waiting.front();
    waiting.pop_front();
    put(byte, deliver);
  }
  if (waiting.empty()) free = std::max(free, now);
}

void Wire::put(uint8_t byte, const Deliver& deliver) {
  uint8_t other;
  if (line_faults_cut(&faults)) {
    free += kCharacterUs;
    return;
  }
  if (line_faults_insert(&faults, &other)) transmit(other, deliver);
  if (line_faults_drop(&faults)) {
    free += kCharacterUs;
    return;
  }
  transmit(byte, deliver);
  if (line_faults_double(&faults)) transmit(byte, deliver);
}

void Wire::transmit(uint8_t byte, const Deliver& deliver) {
  const unsigned levels = line_faults_levels(&faults, byte, free, kBitUs);
  free += kCharacterUs;
  const bool start_bit = !(levels & 1);
  if (start_bit) deliver(static_cast<uint8_t>(levels >> 1));
}

}  // namespace host
}  // namespace mucat
