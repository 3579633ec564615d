// The seam: all that the firmware knows of the board. Declared once, joined by the linker to the AVR's own
// (board/avr) or to the fake on a host (firmware/host). No virtual functions: a call costs two words.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {
namespace board {

// Safe outputs first, then clocks, buses, pins and the watchdog.
void start();
ResetCause reset_cause();

uint32_t microseconds();
uint32_t milliseconds();
// Ticks of 10 ms since the last call.
uint8_t take_ticks();
// Sleeps until the next interrupt, of which a tick or a received byte is one; it may come at once.
void rest();
// To be called at least every 250 ms, else the board resets.
void feed_watchdog();

// The serial line. Reading and writing never wait.
// Bytes that wait for the main loop or for the line, at most.
constexpr uint8_t kLineRoom = 255;
bool read_line(uint8_t* byte);
uint8_t line_room();
void write_line(const uint8_t* bytes, uint8_t size);
// Bytes received and lost for want of room, since the start.
uint16_t bytes_lost();

// Writes, then reads after a repeated start; either size may be 0. False where the device does not answer;
// takes less than 1 ms even then.
bool exchange_i2c(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size);

constexpr uint8_t kEncoderBytes = 3;
void read_encoder(uint8_t fin, uint8_t (&bytes)[kEncoderBytes]);

// The battery's converter: start, and take the counts (0 to 1023) at a later tick.
void start_battery();
uint16_t take_battery();

bool beacon_right();
bool beacon_left();
void set_led(bool on);
void set_motor_power(bool on);

// Counts the boots in memory that outlives a power cycle; never 0.
uint16_t next_epoch();
// Memory that outlives a reset but not a power cycle; anything may stand in it at power-on.
struct RetainedMemory {
  uint32_t value;
  uint32_t complement;
};
RetainedMemory& retained_memory();
// Bytes that the stack never touched.
uint16_t stack_free();

}  // namespace board
}  // namespace mucat
