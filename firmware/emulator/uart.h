// SPDX-License-Identifier: GPL-3.0-or-later
// The chip's UART on a bit-timed line, one of two ends; 8N1, the other end is the host's port.
//
// libsimavr's UART has a receive buffer of 64 characters, counts 11 bits a character, has no buffer for a
// second character to send, and slows down a program that reads quickly. All of that is corrected here.
#ifndef UART_H
#define UART_H

#include <avr_uart.h>

#include "chip.h"
#include "line.h"

struct uart {
  struct chip *chip;
  avr_uart_t *module;
  struct line to_board;
  struct line *to_host;
  struct chip_write_hook data_written, baud_written, control_written;
  avr_io_read_t inner_read;
  void *inner_read_param;
  avr_cycle_timer_t buffer_timer;  // libsimavr's, for the end of the transmit buffer
  double buffer_free;              // cycle at which the character just written leaves the transmit buffer
  bool written;
  struct chip_timer sent;
  unsigned long bytes_received;
  unsigned long framing_errors;
  unsigned long overruns;
  unsigned long bytes_sent;
};

void uart_create(struct uart *uart, struct chip *chip, struct line *to_host);

// Call it after every reset of the chip.
void uart_reset(struct uart *uart);

// Cycles of a bit at the speed that the program has set.
double uart_bit(const struct uart *uart);

#endif
