// Does to the chip's parts what single-letter commands ask for, and tells how long it took in timer ticks of
// 0.5 us. At the start it says 'R' and the reset cause.
#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <util/twi.h>

#include "serial.h"

// An upload leaves the EEPROM alone, this too.
uint8_t in_the_elf EEMEM __attribute__((used)) = 0x11;

static uint8_t reset_cause __attribute__((section(".noinit")));
static uint8_t filled[512] __attribute__((section(".noinit")));

void keep_reset_cause(void) __attribute__((naked, used, section(".init3")));
void keep_reset_cause(void) {
  reset_cause = MCUSR;
  MCUSR = 0;
  wdt_disable();
}

static void put_word(uint16_t word) {
  serial_put(word & 0xff);
  serial_put(word >> 8);
}

static void start_timer(void) { TCNT1 = 0; }
static uint16_t timer(void) { return TCNT1; }

static uint8_t twi_step(uint8_t control) {
  TWCR = control | _BV(TWINT) | _BV(TWEN);
  while (!(TWCR & _BV(TWINT))) {
  }
  return TW_STATUS;
}

static uint8_t twi_address(uint8_t address) {
  twi_step(_BV(TWSTA));
  TWDR = address;
  return twi_step(0);
}

// address, bytes to write, count to read -> last status, ticks, bytes read
static void do_twi(void) {
  uint8_t address = serial_get() << 1, out_count = serial_get(), out[16], in[16] = {0};
  for (uint8_t i = 0; i < out_count; i++) out[i] = serial_get();
  uint8_t in_count = serial_get(), status = TW_MT_SLA_ACK;
  start_timer();
  if (out_count || !in_count) {
    status = twi_address(address);
    for (uint8_t i = 0; i < out_count && (status == TW_MT_SLA_ACK || status == TW_MT_DATA_ACK); i++) {
      TWDR = out[i];
      status = twi_step(0);
    }
  }
  if (in_count && (status == TW_MT_SLA_ACK || status == TW_MT_DATA_ACK)) {
    status = twi_address(address | 1);
    for (uint8_t i = 0; i < in_count && (status == TW_MR_SLA_ACK || status == TW_MR_DATA_ACK); i++) {
      status = twi_step(i + 1 < in_count ? _BV(TWEA) : 0);
      in[i] = TWDR;
    }
  }
  uint16_t ticks = timer();
  TWCR = _BV(TWSTO) | _BV(TWINT) | _BV(TWEN);
  serial_put(status);
  put_word(ticks);
  for (uint8_t i = 0; i < in_count; i++) serial_put(in[i]);
}

static void select(uint8_t encoder, uint8_t high) {
  static const uint8_t port_b[] = {0, _BV(PB0), _BV(PB1), _BV(PB2)};
  if (encoder == 0) {
    PORTD = high ? PORTD | _BV(PD7) : PORTD & ~_BV(PD7);
  } else {
    PORTB = high ? PORTB | port_b[encoder] : PORTB & ~port_b[encoder];
  }
}

// encoder -> ticks, three bytes
static void do_spi(void) {
  uint8_t encoder = serial_get(), bytes[3];
  select(encoder, 0);
  start_timer();
  for (uint8_t i = 0; i < 3; i++) {
    SPDR = 0;
    while (!(SPSR & _BV(SPIF))) {
    }
    bytes[i] = SPDR;
  }
  uint16_t ticks = timer();
  select(encoder, 1);
  put_word(ticks);
  for (uint8_t i = 0; i < 3; i++) serial_put(bytes[i]);
}

// channel -> counts
static void do_adc(void) {
  ADMUX = _BV(REFS0) | serial_get();
  ADCSRA |= _BV(ADSC);
  while (ADCSRA & _BV(ADSC)) {
  }
  put_word(ADC);
}

// address, value -> ticks until it is written
static void do_eeprom(void) {
  uint16_t address = serial_get();
  uint8_t value = serial_get();
  start_timer();
  eeprom_write_byte((uint8_t *)address, value);
  eeprom_busy_wait();
  put_word(timer());
}

// -> ticks that 16 bytes took from the first write until the last had gone
static void do_flood(void) {
  while (!(UCSR0A & _BV(UDRE0))) {
  }
  start_timer();
  for (uint8_t i = 0; i < 16; i++) {
    serial_put('x');
    UCSR0A |= _BV(TXC0);
  }
  while (!(UCSR0A & _BV(TXC0))) {
  }
  put_word(timer());
}

// -> ticks between two overflows of timer 2 in phase-correct PWM, at an eighth of the chip's clock
static void do_overflow(void) {
  TCCR2A = _BV(WGM20);
  TCCR2B = _BV(CS21);
  for (uint8_t overflow = 0; overflow < 2; overflow++) {
    TIFR2 = _BV(TOV2);
    while (!(TIFR2 & _BV(TOV2))) {
    }
    if (!overflow) {
      start_timer();
    }
  }
  uint16_t ticks = timer();
  TCCR2B = 0;
  put_word(ticks);
}

// -> bytes of the filled memory that are not as filled
static void do_count(void) {
  uint16_t lost = 0;
  for (uint16_t i = 0; i < sizeof filled; i++) lost += filled[i] != (uint8_t)(i + (i >> 8));
  put_word(lost);
}

static void do_command(uint8_t command) {
  switch (command) {
    case 'T':
      do_twi();
      break;
    case 't':
      TWBR = serial_get();
      break;
    case 'S':
      do_spi();
      break;
    case 'M':
      SPCR = (SPCR & ~(_BV(CPOL) | _BV(CPHA))) | serial_get();
      break;
    case 'A':
      do_adc();
      break;
    case 'E':
      do_eeprom();
      break;
    case 'e':
      serial_put(eeprom_read_byte((uint8_t *)(uint16_t)serial_get()));
      break;
    case 'F':
      do_flood();
      break;
    case 'P':
      do_overflow();
      break;
    case 'W':
      for (uint16_t i = 0; i < sizeof filled; i++) filled[i] = (uint8_t)(i + (i >> 8));
      break;
    case 'w':
      do_count();
      break;
    case 'O':
      PORTC = serial_get();
      break;
    case 'I':
      serial_put(PIND);
      break;
    case 'H':
      wdt_enable(WDTO_250MS);
      for (;;) {
      }
    case 'Z':
      wdt_enable(WDTO_250MS);
      cli();
      sleep_mode();
      break;
    case 'J':
      wdt_enable(WDTO_250MS);
      ((void (*)(void))0x3800)();
      break;
  }
}

int main(void) {
  serial_begin(UBRR_115200);
  TCCR1B = _BV(CS11);
  TWBR = 12;
  ADCSRA = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
  PORTB = _BV(PB0) | _BV(PB1) | _BV(PB2);
  DDRB = _BV(PB0) | _BV(PB1) | _BV(PB2) | _BV(PB3) | _BV(PB5);
  PORTD = _BV(PD7);
  DDRD = _BV(PD7);
  DDRC = _BV(PC1) | _BV(PC3);
  SPCR = _BV(SPE) | _BV(MSTR) | _BV(CPOL) | _BV(CPHA) | _BV(SPR0);
  serial_put('R');
  serial_put(reset_cause);
  for (;;) do_command(serial_get());
}
