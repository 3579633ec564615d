// A board in memory, for tests on a computer: it implements board/board.h. Time passes only by `advance`.
#pragma once
#include <stdint.h>

#include <deque>
#include <vector>

#include "board/board.h"

namespace mucat {
namespace host {

// Answers an I2C transfer; 0 if no device answers.
using I2cBus = uint8_t (*)(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in,
                           uint8_t in_size);

constexpr uint8_t kEepromBytes = 100;

// It begins calibrated as the emulated board.
struct Board {
  Board();

  uint64_t now_us = 0;
  uint64_t ticks_taken = 0;
  ResetCause cause = ResetCause::kPowerOn;
  uint16_t epoch = 0;
  uint8_t eeprom[kEepromBytes];
  board::RetainedMemory retained = {};

  std::deque<uint8_t> to_board;
  std::deque<uint8_t> waiting;  // written by the firmware, not yet on the line
  std::vector<uint8_t> to_host;
  uint64_t line_free_us = 0;
  uint32_t overwritten = 0;  // bytes that were written without room

  I2cBus i2c = nullptr;
  uint16_t encoders[kFinCount] = {};  // the AS5040's 16 bits
  uint16_t battery = 0;
  bool right = false;
  bool left = false;
  bool leak = false;
  bool led = false;
  bool motor_power = false;
  uint64_t fed_us = 0;
};

extern Board the_board;

// Lets time pass: the line sends waiting bytes at its baud.
void advance(uint32_t us);
// Resets the board; the boot counter and the surroundings stay, and retained memory but at power-on.
void reset(ResetCause cause);

}  // namespace host
}  // namespace mucat
