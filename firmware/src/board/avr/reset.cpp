// Resets: their cause, safe outputs, the watchdog, and memory that survives them.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "board/avr/parts.h"
#include "board/board.h"

namespace mucat {
namespace board {
namespace {

// Not cleared by the C runtime; written before it runs.
__attribute__((section(".noinit"))) uint8_t reset_flags;
__attribute__((section(".noinit"))) RetainedMemory retained;

constexpr uint8_t kUnusedStack = 0xC5;

}  // namespace

extern "C" {
extern uint8_t _end;

// Runs before the C runtime sets up memory. First it switches the motor power off. After a watchdog reset the
// watchdog stays on with its shortest timeout, so it is set again at once. A bootloader clears MCUSR and
// leaves its value in r2. The free memory is filled with a pattern, so that stack_free() finds the deepest
// use of the stack.
__attribute__((naked, used, section(".init3"))) void mucat_early_start(void) {
  PORTC &= static_cast<uint8_t>(~_BV(PC3));
  DDRC |= _BV(PC3);
  uint8_t from_bootloader;
  __asm__ __volatile__("mov %0, r2" : "=r"(from_bootloader));
  const uint8_t flags = MCUSR;
  reset_flags = flags ? flags : from_bootloader;
  MCUSR = 0;
  wdt_enable(WDTO_250MS);
  for (uint8_t* at = &_end; at <= reinterpret_cast<uint8_t*>(RAMEND - 16); ++at) *at = kUnusedStack;
}
}

void start() {
  start_pins();
  start_clock();
  start_line();
  start_i2c();
  start_spi();
  sei();
}

ResetCause reset_cause() {
  if (reset_flags & _BV(PORF)) return ResetCause::kPowerOn;
  if (reset_flags & _BV(BORF)) return ResetCause::kBrownOut;
  // Checked before the watchdog: after the reset pin, a bootloader starts the sketch by a watchdog reset.
  if (reset_flags & _BV(EXTRF)) return ResetCause::kExternal;
  if (reset_flags & _BV(WDRF)) return ResetCause::kWatchdog;
  return ResetCause::kUnknown;
}

void feed_watchdog() { wdt_reset(); }

RetainedMemory& retained_memory() { return retained; }

uint16_t stack_free() {
  const uint8_t* at = &_end;
  while (*at == kUnusedStack && at < reinterpret_cast<uint8_t*>(SP)) ++at;
  return at - &_end;
}

}  // namespace board
}  // namespace mucat
#endif
