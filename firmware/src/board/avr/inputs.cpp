// The battery's converter (A2), the beacon detectors (D4, D5) and the leak sensor (D2).
#ifdef __AVR__
#include <avr/io.h>

#include "board/board.h"

namespace mucat {
namespace board {

void start_battery() { ADCSRA |= _BV(ADSC); }

uint16_t take_battery() { return ADC; }

bool beacon_right() { return PIND & _BV(PD4); }

bool beacon_left() { return PIND & _BV(PD5); }

bool leak() { return !(PIND & _BV(PD2)); }

}  // namespace board
}  // namespace mucat
#endif
