// Looks at the receiver once in 50 ms: sends back what it holds, and after each byte the flags FE and DOR.
#include <util/delay.h>

#include "serial.h"

int main(void) {
  serial_begin(UBRR_115200);
  for (;;) {
    _delay_ms(50);
    while (UCSR0A & _BV(RXC0)) {
      uint8_t flags = UCSR0A & (_BV(FE0) | _BV(DOR0));
      uint8_t byte = UDR0;
      serial_put(byte);
      serial_put(flags);
    }
  }
}
