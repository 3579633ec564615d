// Sends back every byte, as a program with interrupts does. The bytes 1 to 4 also choose a new speed, once
// they have gone out: 9600, 115200, 250000 and 500000 baud. After the byte 0 it shuts out interrupts for 45
// us in every round of its main loop.
#include <avr/interrupt.h>
#include <util/delay.h>

#include "serial.h"

static volatile uint8_t ring[256], head, tail;

ISR(USART_RX_vect) {
  ring[head] = UDR0;
  head++;
}

int main(void) {
  static const uint16_t speeds[] = {207, UBRR_115200, UBRR_250000, 3};
  uint8_t busy = 0;
  serial_begin(UBRR_115200);
  UCSR0B |= _BV(RXCIE0);
  sei();
  for (;;) {
    if (busy) {
      cli();
      _delay_us(45);
      sei();
      _delay_us(100);
    }
    if (head == tail) continue;
    uint8_t byte = ring[tail++];
    UCSR0A |= _BV(TXC0);
    serial_put(byte);
    busy |= byte == 0;
    if (byte >= 1 && byte <= 4) {
      while (!(UCSR0A & _BV(TXC0))) {
      }
      serial_begin(speeds[byte - 1]);
      UCSR0B |= _BV(RXCIE0);
    }
  }
}
