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

// Not cleared by the C runtime; the first is written before it runs.
__attribute__((section(".noinit"))) uint8_t reset_flags;
__attribute__((section(".noinit"))) RetainedMemory retained;
__attribute__((section(".noinit"))) uint16_t mark;
__attribute__((section(".noinit"))) uint16_t mark_complement;

// At power-on the memory is random, and holds the mark and its complement once in 2^32 times.
constexpr uint16_t kMark = 0x5EA7;
// Ticks without feeding after which nothing but the watchdog resets a chip whose main loop runs: 25 pass
// before it bites, and its clock may be 10 % fast.
constexpr uint8_t kHungTicks = 20;
constexpr uint8_t kUnusedStack = 0xC5;

ResetCause cause;

// Boot loaders such as optiboot clear MCUSR, and the older ones do not pass it on.
ResetCause find_cause() {
  if (reset_flags & _BV(PORF)) return ResetCause::kPowerOn;
  if (reset_flags & _BV(BORF)) return ResetCause::kBrownOut;
  // Checked before the watchdog: after the reset pin, a boot loader starts the sketch by a watchdog reset.
  if (reset_flags & _BV(EXTRF)) return ResetCause::kExternal;
  if (reset_flags & _BV(WDRF)) return ResetCause::kWatchdog;
  const bool survived = mark == kMark && mark_complement == static_cast<uint16_t>(~kMark);
  if (!survived) return ResetCause::kPowerOn;
  const bool hung = unfed_ticks >= kHungTicks && (unfed_ticks ^ unfed_complement) == UINT8_MAX;
  return hung ? ResetCause::kWatchdog : ResetCause::kExternal;
}

}  // namespace

extern "C" {
extern uint8_t _end;

// Runs before the C runtime sets up memory. First it switches the motor power off. After a watchdog reset the
// watchdog stays on with its shortest timeout, so it is set again at once. The free memory is filled with a
// pattern, so that stack_free() finds the deepest use of the stack.
__attribute__((naked, used, section(".init3"))) void mucat_early_start(void) {
  PORTC &= static_cast<uint8_t>(~_BV(PC3));
  DDRC |= _BV(PC3);
  reset_flags = MCUSR;
  MCUSR = 0;
  wdt_enable(WDTO_250MS);
  for (uint8_t* at = &_end; at <= reinterpret_cast<uint8_t*>(RAMEND - 16); ++at) *at = kUnusedStack;
}
}

void start() {
  cause = find_cause();
  mark = kMark;
  mark_complement = ~kMark;
  start_pins();
  start_clock();
  start_line();
  start_i2c();
  start_spi();
  feed_watchdog();
  sei();
}

ResetCause reset_cause() { return cause; }

void feed_watchdog() {
  unfed_ticks = 0;
  unfed_complement = UINT8_MAX;
  wdt_reset();
}

RetainedMemory& retained_memory() { return retained; }

uint16_t stack_free() {
  const uint8_t* at = &_end;
  while (*at == kUnusedStack && at < reinterpret_cast<uint8_t*>(SP)) ++at;
  return at - &_end;
}

}  // namespace board
}  // namespace mucat
#endif
