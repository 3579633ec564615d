// The serial line by interrupts. The core's Serial is not used: its rings hold 64 bytes, which is 2.5 ms at
// 250 kbaud, and it does not count the bytes it loses. The index of a ring of 256 bytes wraps by itself.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "board/avr/parts.h"
#include "board/board.h"
#include "link/baud.h"

namespace mucat {
namespace board {
namespace {

constexpr uint32_t divisor(uint8_t samples) { return (F_CPU + samples * kBaud / 2) / (samples * kBaud) - 1; }
// Deviation of the chip's rate from kBaud, in thousandths.
constexpr int32_t rate_error(uint8_t samples) {
  return static_cast<int32_t>(F_CPU / (samples * (divisor(samples) + 1)) * 1000 / kBaud) - 1000;
}
constexpr int32_t magnitude(int32_t value) { return value < 0 ? -value : value; }

constexpr bool kDoubled = magnitude(rate_error(8)) < magnitude(rate_error(16));
constexpr uint8_t kSamples = kDoubled ? 8 : 16;
static_assert(magnitude(rate_error(kSamples)) <= 25, "this baud is more than 2.5 % off on this clock");
static_assert(divisor(kSamples) <= 4095, "this baud is too low for the chip");

uint8_t received[256];
volatile uint8_t received_head;
volatile uint8_t received_tail;
volatile uint16_t lost;

uint8_t outgoing[256];
volatile uint8_t outgoing_head;
volatile uint8_t outgoing_tail;

}  // namespace

ISR(USART_RX_vect) {
  // The overrun flag belongs to the byte in UDR0; reading that clears it.
  const bool overrun = UCSR0A & _BV(DOR0);
  const uint8_t byte = UDR0;
  const uint8_t next = received_head + 1;
  if (overrun) ++lost;
  if (next == received_tail) {
    ++lost;
    return;
  }
  received[received_head] = byte;
  received_head = next;
}

ISR(USART_UDRE_vect) {
  UDR0 = outgoing[outgoing_tail];
  if (++outgoing_tail == outgoing_head) UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
}

void start_line() {
  UBRR0 = divisor(kSamples);
  UCSR0A = kDoubled ? _BV(U2X0) : 0;
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);
}

bool read_line(uint8_t* byte) {
  if (received_head == received_tail) return false;
  *byte = received[received_tail];
  received_tail = received_tail + 1;
  return true;
}

uint8_t line_room() { return outgoing_tail - outgoing_head - 1; }

void write_line(const uint8_t* bytes, uint8_t size) {
  uint8_t head = outgoing_head;
  while (size--) outgoing[head++] = *bytes++;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    outgoing_head = head;
    UCSR0B |= _BV(UDRIE0);
  }
}

uint16_t bytes_lost() {
  uint16_t count;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { count = lost; }
  return count;
}

}  // namespace board
}  // namespace mucat
#endif
