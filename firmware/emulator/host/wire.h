// SPDX-License-Identifier: GPL-3.0-or-later
// One direction of the serial line, a character at a time, with its faults. With a wrong
// start bit the character is lost; only the emulated board has receivers that take another edge for it.
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

  // Delivers the waiting characters that arrive until `now` (us).
  void carry(double now, const Deliver& deliver);

  std::deque<uint8_t> waiting;
  double free = 0;           // us, end of the last character
  double stalled_until = 0;  // us
  line_faults faults = {};

 private:
  void put(uint8_t byte, const Deliver& deliver);
  void transmit(uint8_t byte, const Deliver& deliver);
};

}  // namespace host
}  // namespace mucat

#endif
