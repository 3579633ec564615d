// The board's interface: everything that the firmware uses of the board. The linker joins it to the AVR
// (board/avr) or to the host's board in memory (firmware/host). No virtual functions: a call costs two words.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {
namespace board {

// Safe outputs first, then clocks, buses, pins and the watchdog.
void start();
// Behind a boot loader that hides it, a brown-out or a hang with interrupts off appears as the reset pin.
ResetCause reset_cause();

uint32_t microseconds();
uint32_t milliseconds();
// Ticks of 10 ms since the last call.
uint8_t take_ticks();
// Sleeps until the next interrupt, such as a tick or a received byte; may return at once.
void rest();
// Call it at least every 250 ms; otherwise the board resets.
void feed_watchdog();

// The serial line. Reading and writing never wait.
// Size of each of the two rings: received bytes, and bytes to send.
constexpr uint8_t kLineRoom = 255;
bool read_line(uint8_t* byte);
uint8_t line_room();
void write_line(const uint8_t* bytes, uint8_t size);
// Received bytes that were lost since the start, because the ring was full or the interrupt came late.
uint16_t bytes_lost();

// Writes, then reads after a repeated start; either size may be 0. False if the device does not answer, in
// less than 1 ms.
bool exchange_i2c(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size);

constexpr uint8_t kEncoderBytes = 3;
void read_encoder(uint8_t fin, uint8_t (&bytes)[kEncoderBytes]);

// The battery's converter: start it, and read the counts (0 to 1023) at a later tick.
void start_battery();
uint16_t take_battery();

bool beacon_right();
bool beacon_left();
// True while there is water between the wires of the leak sensor.
bool leak();
void set_led(bool on);
void set_motor_power(bool on);

// Number of this boot, from memory that survives a power cycle; never 0.
uint16_t next_epoch();
// More memory that survives a power cycle, at most 100 bytes: the calibration at 0, then the surface.
constexpr uint8_t kSurfaceAt = 32;
void read_eeprom(uint8_t index, void* bytes, uint8_t size);
// Begins to write a byte, which takes 4 ms; waits while the one before it is written.
void write_eeprom(uint8_t index, uint8_t byte);
// Memory that survives a reset but not a power cycle; its content at power-on is random.
struct RetainedMemory {
  uint32_t value;
  uint32_t complement;
};
RetainedMemory& retained_memory();
// Bytes of memory that the stack has never used.
uint16_t stack_free();

}  // namespace board
}  // namespace mucat
