// The encoders on SPI: mode 3 at 1 MHz, one chip select each on D7 to D10.
#ifdef __AVR__
#include <avr/io.h>
#include <util/delay.h>

#include "board/avr/parts.h"
#include "board/board.h"

namespace mucat {
namespace board {
namespace {

void select(uint8_t fin, bool on) {
  volatile uint8_t& port = fin == 0 ? PORTD : PORTB;
  const uint8_t bit = fin == 0 ? _BV(PD7) : _BV(PB0) << (fin - 1);
  if (on) {
    port &= static_cast<uint8_t>(~bit);
  } else {
    port |= bit;
  }
}

}  // namespace

void start_spi() {
  PORTD |= _BV(PD7);
  DDRD |= _BV(PD7);
  PORTB |= _BV(PB0) | _BV(PB1) | _BV(PB2);
  // The pull-up on MISO (D12) makes a missing encoder read as ones, which the driver refuses.
  PORTB |= _BV(PB4);
  DDRB |= _BV(PB0) | _BV(PB1) | _BV(PB2) | _BV(PB3) | _BV(PB5);
  SPCR = _BV(SPE) | _BV(MSTR) | _BV(CPOL) | _BV(CPHA) | _BV(SPR0);
  SPSR = 0;
}

void read_encoder(uint8_t fin, uint8_t (&bytes)[kEncoderBytes]) {
  select(fin, true);
  // The AS5040 needs 500 ns between its select and the first clock.
  _delay_us(1);
  for (uint8_t& byte : bytes) {
    SPDR = 0;
    for (uint8_t remaining = UINT8_MAX; remaining && !(SPSR & _BV(SPIF)); --remaining) {
    }
    byte = SPDR;
  }
  select(fin, false);
}

}  // namespace board
}  // namespace mucat
#endif
