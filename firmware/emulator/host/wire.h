// SPDX-License-Identifier: GPL-3.0-or-later
// One direction of the serial line, a character at a time, with its faults. Where a start
// bit is disturbed the character is lost; a receiver that takes another edge for it is left to the emulated
// board.
#ifndef HOST_WIRE_H
#define HOST_WIRE_H

#include <stddef.h>

#include <deque>
#include <functional>

extern "C" {
#include "line_faults.h"
}

namespace mucat {
namespace host {

struct Wire {
  using Deliver = std::function<void(uint8_t byte)>;

  // Carries what waits and has time to arrive until `now` (us).
  void carry(double now, const Deliver& deliver);

  std::deque<uint8_t> waiting;
  double free = 0;           // us at which the last character has gone
  double stalled_until = 0;  // us
  line_faults faults = {};

 private:
  void put(uint8_t byte, const Deliver& deliver);
  void transmit(uint8_t byte, const Deliver& deliver);
};

}  // namespace host
}  // namespace mucat

#endif
