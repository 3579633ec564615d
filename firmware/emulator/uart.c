// SPDX-License-Identifier: GPL-3.0-or-later
#include "uart.h"

#include <sim_regbit.h>

#include "registers.h"

#define RECEIVE_CHARACTERS_MAX 3  // the chip's buffer of two, and its shift register

double uart_bit(const struct uart *uart) {
  avr_t *avr = uart->chip->avr;
  const avr_uart_t *module = uart->module;
  unsigned ubrr = avr_regbit_get(avr, module->ubrrl) | avr_regbit_get(avr, module->ubrrh) << 8;
  return (ubrr + 1) * (avr_regbit_get(avr, module->u2x) ? 8.0 : 16.0);
}

static unsigned characters_waiting(const avr_uart_t *module) {
  return (unsigned)(module->input.write - module->input.read) % uart_fifo_fifo_size;
}

static void on_received(void *owner, uint8_t byte, bool framing_error) {
  struct uart *uart = owner;
  avr_t *avr = uart->chip->avr;
  avr_uart_t *module = uart->module;
  uart->bytes_received++;
  uart->framing_errors += framing_error;
  if (!avr_regbit_get(avr, module->rxen)) {
    return;
  }
  if (characters_waiting(module) >= RECEIVE_CHARACTERS_MAX) {
    uart->overruns++;
    avr_regbit_set(avr, module->dor);
    return;
  }
  // The character's time on the line has already passed; libsimavr would wait for it again.
  avr_cycle_count_t cycles_per_byte = module->cycles_per_byte;
  module->cycles_per_byte = 1;
  avr_raise_irq(module->io.irq + UART_IRQ_INPUT, byte | (framing_error ? UART_INPUT_FE : 0u));
  module->cycles_per_byte = cycles_per_byte;
}

// The program reads a character.
static uint8_t on_read(avr_t *avr, avr_io_addr_t address, void *param) {
  struct uart *uart = param;
  avr_uart_t *module = uart->module;
  uint8_t byte = uart->inner_read(avr, address, uart->inner_read_param);
  // libsimavr would report the next one only a character's time later.
  if (characters_waiting(module)) {
    avr_raise_interrupt(avr, &module->rxc);
  }
  return byte;
}

static void on_transmit(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  struct uart *uart = param;
  double bit = uart_bit(uart);
  double now = (double)chip_now(uart->chip);
  if (uart->buffer_free > now + 1) {
    return;  // the transmit buffer is full: the chip ignores the write
  }
  uart->buffer_free = uart->to_host->sender_free;
  uart->written = true;
  uart->bytes_sent++;
  double end = line_send(uart->to_host, (uint8_t)value, bit);
  chip_timer_start(&uart->sent, (avr_cycle_count_t)end);
}

static void on_data_written(void *owner, uint8_t value) {
  (void)value;
  struct uart *uart = owner;
  if (!uart->written) {
    return;
  }
  uart->written = false;
  uart->module->tx_cnt = 0;  // otherwise libsimavr sets TXC too early
  double delay = uart->buffer_free - (double)chip_now(uart->chip);
  avr_cycle_timer_register(uart->chip->avr, delay > 2 ? (avr_cycle_count_t)delay : 2, uart->buffer_timer,
                           uart->module);
}

static void on_sent(void *owner) {
  struct uart *uart = owner;
  avr_raise_interrupt(uart->chip->avr, &uart->module->txc);
}

static void follow_baud(struct uart *uart) {
  double bit = uart_bit(uart);
  uart->module->cycles_per_byte = (avr_cycle_count_t)(CHARACTER_BITS * bit);
  uart->to_board.receiver_bit = bit;
}

static void on_baud_written(void *owner, uint8_t value) {
  (void)value;
  follow_baud(owner);
}

// libsimavr does not expose its timer; writing a character reveals it.
static avr_cycle_timer_t find_buffer_timer(struct chip *chip, avr_uart_t *module) {
  avr_t *avr = chip->avr;
  avr_regbit_set(avr, module->txen);
  avr->io[AVR_DATA_TO_IO(module->r_udr)].w.c(avr, module->r_udr, 0, module);
  avr_cycle_timer_slot_p slot = chip_module_timer(chip, module);
  return slot ? slot->timer : NULL;
}

void uart_create(struct uart *uart, struct chip *chip, struct line *to_host) {
  avr_uart_t *module = chip_module(chip, "uart");
  *uart = (struct uart){.chip = chip, .module = module, .to_host = to_host};
  uint32_t flags = 0;
  avr_ioctl(chip->avr, AVR_IOCTL_UART_SET_FLAGS(module->name), &flags);
  uart->buffer_timer = find_buffer_timer(chip, module);
  line_create(&uart->to_board, chip, uart_bit(uart), on_received, uart);
  chip_timer_add(chip, &uart->sent, on_sent, uart);
  chip_hook_write(chip, module->r_udr, &uart->data_written, on_data_written, uart);
  chip_hook_write(chip, REGISTER_UBRR0L, &uart->baud_written, on_baud_written, uart);
  chip_hook_write(chip, REGISTER_UCSR0A, &uart->control_written, on_baud_written, uart);
  avr_io_addr_t io = AVR_DATA_TO_IO(module->r_udr);
  uart->inner_read = chip->avr->io[io].r.c;
  uart->inner_read_param = chip->avr->io[io].r.param;
  chip->avr->io[io].r.c = on_read;
  chip->avr->io[io].r.param = uart;
  avr_irq_register_notify(module->io.irq + UART_IRQ_OUTPUT, on_transmit, uart);
}

void uart_reset(struct uart *uart) {
  line_cut(uart->to_host);
  uart->buffer_free = 0;
  chip_timer_stop(&uart->sent);
  follow_baud(uart);
}
