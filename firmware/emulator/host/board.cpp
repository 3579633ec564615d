// SPDX-License-Identifier: GPL-3.0-or-later
#include "board.h"

#include <math.h>
#include <string.h>

#include "calibration.gen.h"

namespace mucat {
namespace host {

Board* current;

namespace {

constexpr uint64_t kTickUs = 10000;
constexpr uint16_t kCountsMax = 1023;
constexpr size_t kPortBytesMax = 4096;  // as much as Linux buffers for a serial port

double seconds(const void* owner) { return static_cast<const Board*>(owner)->now_us * 1e-6; }

}  // namespace

Board::Board() {
  devices_create(&parts, {seconds, this});
  memcpy(eeprom, calibration_record, sizeof calibration_record);
}

void Board::reset(ResetCause why) {
  current = this;
  cause = why;
  ticks_taken = now_us / kTickUs;
  received.clear();
  from_board.waiting.clear();
  bytes_lost = 0;
  led = false;
  devices_set_motor_power(&parts, false);
  robot.reset(new Robot);
  robot->start();
}

void Board::advance() {
  current = this;
  now_us += 1000;
  motors_step(&parts.motors);
  if (now_us > to_board.stalled_until) {
    to_board.carry(now_us, [this](uint8_t byte) {
      if (received.size() < board::kLineRoom) {
        received.push_back(byte);
      } else {
        ++bytes_lost;
      }
    });
  } else {
    to_board.free = now_us;
  }
  do {
    resting = false;
    robot->step();
  } while (!resting || !received.empty());
  from_board.carry(now_us, [this](uint8_t byte) {
    if (for_host.size() < kPortBytesMax) for_host.push_back(byte);
  });
}

}  // namespace host

namespace board {

using host::current;

void start() {}

ResetCause reset_cause() { return current->cause; }

uint32_t microseconds() { return static_cast<uint32_t>(current->now_us); }

uint32_t milliseconds() { return static_cast<uint32_t>(current->now_us / 1000); }

uint8_t take_ticks() {
  const uint64_t all = current->now_us / host::kTickUs;
  const uint64_t taken = all - current->ticks_taken;
  current->ticks_taken = all;
  return static_cast<uint8_t>(taken);
}

void rest() { current->resting = true; }

void feed_watchdog() {}

bool read_line(uint8_t* byte) {
  if (current->received.empty()) return false;
  *byte = current->received.front();
  current->received.pop_front();
  return true;
}

uint8_t line_room() { return static_cast<uint8_t>(kLineRoom - current->from_board.waiting.size()); }

void write_line(const uint8_t* bytes, uint8_t size) {
  std::deque<uint8_t>& waiting = current->from_board.waiting;
  waiting.insert(waiting.end(), bytes, bytes + size);
}

uint16_t bytes_lost() { return current->bytes_lost; }

// Several devices at one address all take what is written, and of what they send every 0 wins.
bool exchange_i2c(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size) {
  bool answered = false;
  for (const i2c_device& device : current->parts.i2c) {
    if (device.address != address) continue;
    if (out_size && !device.start(device.device)) continue;
    for (uint8_t i = 0; i < out_size; ++i) device.write(device.device, i, out[i]);
    if (in_size && !device.start(device.device)) continue;
    for (uint8_t i = 0; i < in_size; ++i) {
      const uint8_t byte = device.read(device.device);
      in[i] = answered ? in[i] & byte : byte;
    }
    answered = true;
  }
  return answered;
}

void read_encoder(uint8_t fin, uint8_t (&bytes)[kEncoderBytes]) {
  as5040* const encoder = &current->parts.encoders[fin];
  as5040_select(encoder, true);
  for (uint8_t& byte : bytes) byte = devices_exchange_spi(&current->parts, false);
  as5040_select(encoder, false);
}

void start_battery() {
  current->battery_counts = static_cast<uint16_t>(host::kCountsMax * devices_battery(&current->parts));
}

uint16_t take_battery() { return current->battery_counts; }

bool beacon_right() {
  bool levels[2];
  devices_beacons(&current->parts, levels);
  return levels[0];
}

bool beacon_left() {
  bool levels[2];
  devices_beacons(&current->parts, levels);
  return levels[1];
}

bool leak() { return current->parts.leak; }

void set_led(bool on) { current->led = on; }

void set_motor_power(bool on) { devices_set_motor_power(&current->parts, on); }

uint16_t next_epoch() {
  if (++current->epoch == 0) current->epoch = 1;
  return current->epoch;
}

void read_eeprom(uint8_t index, void* bytes, uint8_t size) { memcpy(bytes, current->eeprom + index, size); }

void write_eeprom(uint8_t index, uint8_t byte) { current->eeprom[index] = byte; }

RetainedMemory& retained_memory() { return current->retained; }

// About what is left on the chip.
uint16_t stack_free() { return 200; }

}  // namespace board
}  // namespace mucat
