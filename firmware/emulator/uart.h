// SPDX-License-Identifier: GPL-3.0-or-later
// The chip's UART on a bit-timed line, one of two ends; 8N1, the other end is the host's port.
//
// libsimavr's UART has a receive buffer of 64 characters, counts 11 bits a character, sends one character at
// a time where the chip has a second one waiting, and slows down a program that reads quickly. All of that is
// set right here.
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
  avr_cycle_timer_t buffer_timer;  // libsimavr's, by which it says that the transmit buffer is free
  double buffer_free;              // cycle at which the character just written leaves the transmit buffer
  bool written;
  struct chip_timer sent;
  unsigned long bytes_received;
  unsigned long framing_errors;
  unsigned long overruns;
  unsigned long bytes_sent;
};

void uart_create(struct uart *uart, struct chip *chip, struct line *to_host);

// To be called after every reset of the chip.
void uart_reset(struct uart *uart);

// Cycles that a bit takes at the speed that the program has chosen.
double uart_bit(const struct uart *uart);

#endif
