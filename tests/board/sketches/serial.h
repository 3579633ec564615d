// The serial line, polled, at 115200 (which is 117647 on this chip) unless UBRR says otherwise.
#ifndef SERIAL_H
#define SERIAL_H

#include <avr/io.h>
#include <stdint.h>

#define UBRR_115200 16
#define UBRR_250000 7

static inline void serial_begin(uint16_t ubrr) {
  UBRR0 = ubrr;
  UCSR0A = _BV(U2X0);
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0);
}

static inline void serial_put(uint8_t byte) {
  while (!(UCSR0A & _BV(UDRE0))) {
  }
  UDR0 = byte;
}

static inline uint8_t serial_get(void) {
  while (!(UCSR0A & _BV(RXC0))) {
  }
  return UDR0;
}

#endif
