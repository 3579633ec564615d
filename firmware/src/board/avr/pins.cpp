// LED (A1), motor power (A3), and the set-up of the inputs (inputs.cpp).
#ifdef __AVR__
#include <avr/io.h>

#include "board/avr/parts.h"
#include "board/board.h"

namespace mucat {
namespace board {
namespace {

void set(uint8_t bit, bool on) {
  if (on) {
    PORTC |= bit;
  } else {
    PORTC &= static_cast<uint8_t>(~bit);
  }
}

}  // namespace

void start_pins() {
  set_motor_power(false);
  set_led(false);
  DDRC |= _BV(PC3) | _BV(PC1);
  DDRD &= static_cast<uint8_t>(~(_BV(PD2) | _BV(PD4) | _BV(PD5)));
  PORTD |= _BV(PD2);  // the pull-up of the leak sensor
  ADMUX = _BV(REFS0) | 2;
  ADCSRA = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
  DIDR0 = _BV(ADC2D);
}

void set_led(bool on) { set(_BV(PC1), on); }

void set_motor_power(bool on) { set(_BV(PC3), on); }

}  // namespace board
}  // namespace mucat
#endif
