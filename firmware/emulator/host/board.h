// SPDX-License-Identifier: GPL-3.0-or-later
// The firmware compiled for this computer, with the emulated board's devices on its buses. Time passes only
// by `advance`; the firmware's computing takes none of it.
#ifndef HOST_BOARD_H
#define HOST_BOARD_H

#include <memory>
#include <vector>

#include "robot.h"
#include "wire.h"

extern "C" {
#include "devices.h"
}

namespace mucat {
namespace host {

struct Board {
  Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  // Resets like the reset pin: devices, EEPROM and retained memory stay.
  void reset(ResetCause cause);
  // Lets a millisecond pass.
  void advance();

  uint64_t now_us = 0;
  uint64_t ticks_taken = 0;
  ResetCause cause = ResetCause::kPowerOn;
  uint16_t epoch = 0;
  uint8_t eeprom[100] = {};  // EEPROM behind the boot counter
  board::RetainedMemory retained = {};
  devices parts;
  Wire to_board, from_board;
  std::deque<uint8_t> received;  // received by the board, not read yet
  uint16_t bytes_lost = 0;
  std::vector<uint8_t> for_host;
  uint16_t battery_counts = 0;
  bool led = false;
  bool resting = false;
  std::unique_ptr<Robot> robot;
};

// The board whose firmware runs now; the firmware's calls have no argument for it.
extern Board* current;

}  // namespace host
}  // namespace mucat

#endif
