// I2C at 400 kHz, polled. Every wait is bounded: a byte takes 23 us, and after 100 us the bus counts as
// stuck. Polled because a transfer is short and the caller needs its result; the Wire library may wait for
// ever.
#ifdef __AVR__
#include <avr/io.h>
#include <util/delay.h>
#include <util/twi.h>

#include "board/avr/parts.h"
#include "board/board.h"

namespace mucat {
namespace board {
namespace {

constexpr uint32_t kClockHz = 400000;
// A pass of a waiting loop takes 8 cycles or more: 200 of them are at least 100 us.
constexpr uint8_t kPassesMax = 200;

bool wait_for(uint8_t control) {
  TWCR = control | _BV(TWINT) | _BV(TWEN);
  for (uint8_t remaining = kPassesMax; remaining; --remaining) {
    if (TWCR & _BV(TWINT)) return true;
  }
  return false;
}

bool send_address(uint8_t address_and_direction) {
  if (!wait_for(_BV(TWSTA))) return false;
  if (TW_STATUS != TW_START && TW_STATUS != TW_REP_START) return false;
  TWDR = address_and_direction;
  if (!wait_for(0)) return false;
  return TW_STATUS == TW_MT_SLA_ACK || TW_STATUS == TW_MR_SLA_ACK;
}

bool stop() {
  TWCR = _BV(TWINT) | _BV(TWSTO) | _BV(TWEN);
  for (uint8_t remaining = kPassesMax; remaining; --remaining) {
    if (!(TWCR & _BV(TWSTO))) return true;
  }
  return false;
}

// A device that was interrupted within a byte holds SDA down until it has got the byte's remaining clocks: at
// most nine, then a stop. External resistors pull the pins up; the chip only pulls them down.
void recover() {
  TWCR = 0;
  PORTC &= static_cast<uint8_t>(~(_BV(PC4) | _BV(PC5)));
  for (uint8_t clock = 0; clock < 9; ++clock) {
    DDRC |= _BV(PC5);
    _delay_us(3);
    DDRC &= static_cast<uint8_t>(~_BV(PC5));
    _delay_us(3);
  }
  DDRC |= _BV(PC4);
  _delay_us(3);
  DDRC &= static_cast<uint8_t>(~_BV(PC4));
  start_i2c();
}

bool transfer(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size) {
  if (out_size) {
    if (!send_address(address << 1 | TW_WRITE)) return false;
    for (uint8_t i = 0; i < out_size; ++i) {
      TWDR = out[i];
      if (!wait_for(0) || TW_STATUS != TW_MT_DATA_ACK) return false;
    }
  }
  if (in_size) {
    if (!send_address(address << 1 | TW_READ)) return false;
    for (uint8_t i = 0; i < in_size; ++i) {
      const bool more = i + 1 < in_size;
      if (!wait_for(more ? _BV(TWEA) : 0)) return false;
      if (TW_STATUS != (more ? TW_MR_DATA_ACK : TW_MR_DATA_NACK)) return false;
      in[i] = TWDR;
    }
  }
  return true;
}

}  // namespace

void start_i2c() {
  TWSR = 0;
  TWBR = (F_CPU / kClockHz - 16) / 2;
  TWCR = _BV(TWEN);
}

bool exchange_i2c(uint8_t address, const uint8_t* out, uint8_t out_size, uint8_t* in, uint8_t in_size) {
  const bool done = transfer(address, out, out_size, in, in_size);
  // TWINT is clear after a timeout; a stop would never get onto the bus then.
  const bool timed_out = !(TWCR & _BV(TWINT));
  if (timed_out || !stop()) {
    recover();
    return false;
  }
  return done;
}

}  // namespace board
}  // namespace mucat
#endif
