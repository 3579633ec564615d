#include "board.h"

#include <string.h>

#include "../emulator/calibration.gen.h"
#include "link/baud.h"

namespace mucat {
namespace host {

Board the_board;

namespace {

constexpr uint64_t kTickUs = 10000;
constexpr uint64_t kByteUs = 10 * 1000000ULL / kBaud;

}  // namespace

Board::Board() {
  memset(eeprom, 0xFF, sizeof eeprom);
  memcpy(eeprom, calibration_record, sizeof calibration_record);
}

void advance(uint32_t us) {
  Board& board = the_board;
  board.now_us += us;
  while (!board.waiting.empty() && board.line_free_us + kByteUs <= board.now_us) {
    board.to_host.push_back(board.waiting.front());
    board.waiting.pop_front();
    board.line_free_us += kByteUs;
  }
  if (board.waiting.empty()) board.line_free_us = board.now_us;
}

void reset(ResetCause cause) {
  Board& board = the_board;
  board.cause = cause;
  if (cause == ResetCause::kPowerOn) board.retained = {};
  board.ticks_taken = board.now_us / kTickUs;
  board.to_board.clear();
  board.waiting.clear();
  board.motor_power = false;
  board.led = false;
}

}  // namespace host

namespace board {

using host::the_board;

void start() {}

ResetCause reset_cause() { return the_board.cause; }

uint32_t microseconds() { return static_cast<uint32_t>(the_board.now_us); }

uint32_t milliseconds() { return static_cast<uint32_t>(the_board.now_us / 1000); }

uint8_t take_ticks() {
  const uint64_t all = the_board.now_us / host::kTickUs;
  const uint64_t taken = all - the_board.ticks_taken;
  the_board.ticks_taken = all;
  return static_cast<uint8_t>(taken);
}

void rest() {}

void feed_watchdog() { the_board.fed_us = the_board.now_us; }

bool read_line(uint8_t* byte) {
  if (the_board.to_board.empty()) return false;
  *byte = the_board.to_board.front();
  the_board.to_board.pop_front();
  return true;
}

uint8_t line_room() { return static_cast<uint8_t>(kLineRoom - the_board.waiting.size()); }

void write_line(const uint8_t* bytes, uint8_t size) {
  if (size > line_room()) {
    the_board.overwritten += size;
    return;
  }
  the_board.waiting.insert(the_board.waiting.end(), bytes, bytes + size);
}

uint16_t bytes_lost() { return 0; }

bool exchange_i2c(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size) {
  return the_board.i2c && the_board.i2c(address, out, out_size, in, in_size);
}

void read_encoder(uint8_t fin, uint8_t (&bytes)[kEncoderBytes]) {
  const uint32_t bits = 0x800000UL | static_cast<uint32_t>(the_board.encoders[fin]) << 7;
  for (uint8_t i = 0; i < kEncoderBytes; ++i) bytes[i] = static_cast<uint8_t>(bits >> (16 - 8 * i));
}

void start_battery() {}

uint16_t take_battery() { return the_board.battery; }

bool beacon_right() { return the_board.right; }

bool beacon_left() { return the_board.left; }

bool leak() { return the_board.leak; }

void set_led(bool on) { the_board.led = on; }

void set_motor_power(bool on) { the_board.motor_power = on; }

uint16_t next_epoch() { return ++the_board.epoch; }

void read_eeprom(uint8_t index, void* bytes, uint8_t size) { memcpy(bytes, the_board.eeprom + index, size); }

void write_eeprom(uint8_t index, uint8_t byte) { the_board.eeprom[index] = byte; }

RetainedMemory& retained_memory() { return the_board.retained; }

// About what is left on the chip.
uint16_t stack_free() { return 200; }

}  // namespace board
}  // namespace mucat
