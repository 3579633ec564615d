// The 100 Hz tick from Timer1. Timer0 stays the Arduino core's, for micros() and millis().
#ifdef __AVR__
#include <Arduino.h>
#include <avr/sleep.h>
#include <util/atomic.h>

#include "board/avr/parts.h"
#include "board/board.h"

namespace mucat {
namespace board {
namespace {

constexpr uint32_t kTickHz = 100;
constexpr uint32_t kPrescaler = 64;
static_assert(F_CPU % (kPrescaler * kTickHz) == 0, "the tick is not exact at this clock");

volatile uint8_t ticks;

}  // namespace

// Here, not beside the reset's cause, whose start-up code switches the watchdog on in every program that
// links it.
__attribute__((section(".noinit"))) volatile uint8_t unfed_ticks;
__attribute__((section(".noinit"))) volatile uint8_t unfed_complement;

ISR(TIMER1_COMPA_vect) {
  if (ticks != UINT8_MAX) ++ticks;
  if (unfed_ticks != UINT8_MAX) unfed_complement = ~++unfed_ticks;
}

void start_clock() {
  TCCR1A = 0;
  TCCR1B = _BV(WGM12) | _BV(CS11) | _BV(CS10);
  OCR1A = F_CPU / kPrescaler / kTickHz - 1;
  TCNT1 = 0;
  TIMSK1 = _BV(OCIE1A);
}

uint32_t microseconds() { return micros(); }

uint32_t milliseconds() { return millis(); }

uint8_t take_ticks() {
  uint8_t taken;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    taken = ticks;
    ticks = 0;
  }
  return taken;
}

void rest() {
  set_sleep_mode(SLEEP_MODE_IDLE);
  cli();
  // Interrupts are off from this check to the sleep: a tick in between would not wake the chip.
  if (ticks == 0) {
    sleep_enable();
    sei();
    sleep_cpu();
    sleep_disable();
  }
  sei();
}

}  // namespace board
}  // namespace mucat
#endif
