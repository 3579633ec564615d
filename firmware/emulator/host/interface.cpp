// SPDX-License-Identifier: GPL-3.0-or-later
// The host board with plain C names, for robot_runtime/simulation/boards/host_board.py.
#include <string.h>

#include "board.h"

extern "C" {
#include "mistakes.h"
}

using mucat::host::Board;
using mucat::host::Wire;

namespace {

enum Direction { kToBoard, kFromBoard };

Wire* wire(Board* board, int direction) {
  return direction == kToBoard ? &board->to_board : &board->from_board;
}

}  // namespace

extern "C" {

// Creates a powered board, before the first pass of its main loop.
Board* board_create() {
  Board* const board = new Board;
  board->reset(mucat::ResetCause::kPowerOn);
  return board;
}

void board_destroy(Board* board) { delete board; }

void board_reset(Board* board) { board->reset(mucat::ResetCause::kExternal); }

void board_send(Board* board, const uint8_t* bytes, uint32_t size) {
  board->to_board.waiting.insert(board->to_board.waiting.end(), bytes, bytes + size);
}

// Lets time pass and writes the bytes for the host into `bytes`; returns their count.
uint32_t board_run(Board* board, uint32_t milliseconds, uint8_t* bytes, uint32_t room) {
  while (milliseconds--) board->advance();
  if (board->now_us <= board->from_board.stalled_until) return 0;
  const uint32_t size = board->for_host.size() < room ? board->for_host.size() : room;
  memcpy(bytes, board->for_host.data(), size);
  board->for_host.erase(board->for_host.begin(), board->for_host.begin() + size);
  return size;
}

// A0..A3 S0..S3 D0..D3 POWER, as in the emulated board's line `fins`.
void board_fins(const Board* board, double* numbers) {
  for (unsigned fin = 0; fin < FIN_COUNT; ++fin) {
    numbers[fin] = motors_fin_angle(&board->parts.motors, fin);
    numbers[FIN_COUNT + fin] = motors_fin_speed(&board->parts.motors, fin);
    numbers[2 * FIN_COUNT + fin] = drv8830_drive(&board->parts.bridges[fin]);
  }
  numbers[3 * FIN_COUNT] = board->parts.motor_power;
}

// Sets the numbers of the emulated board's line `sense`; false if they are impossible.
bool board_sense(Board* board, const double* numbers) {
  surroundings reading;
  const bool possible = surroundings_read(&reading, numbers);
  if (possible) devices_set_surroundings(&board->parts, &reading);
  return possible;
}

bool board_fault(Board* board, const char* device, const char* kind) {
  return devices_set_fault(&board->parts, device, kind);
}

// Adds a mistake of wiring or an imperfection of a part; false if there is none of this name.
bool board_mistake(Board* board, const char* text) {
  wiring changed = board->parts.wiring;
  const bool known = mistakes_add(&changed, text);
  if (known) devices_set_wiring(&board->parts, &changed);
  return known;
}

void board_seed(Board* board, uint64_t seed) {
  line_faults_seed(&board->to_board.faults, 2 * seed + kToBoard);
  line_faults_seed(&board->from_board.faults, 2 * seed + kFromBoard);
}

bool board_disturb(Board* board, int direction, const char* kind, const char* value) {
  const bool done = line_faults_set(&wire(board, direction)->faults, kind, value);
  if (done && !strcmp(kind, "clean")) wire(board, direction)->stalled_until = 0;
  return done;
}

void board_stall(Board* board, int direction, double seconds) {
  wire(board, direction)->stalled_until = board->now_us + 1e6 * seconds;
}
}
