// SPDX-License-Identifier: GPL-3.0-or-later
#include "host_port.h"

#include <string.h>

#define SILENCE_BITS 32

static bool stalled(const struct host_port *port, enum direction direction) {
  return port->stall_ends[direction].armed;
}

static void deliver_received(struct host_port *port) {
  if (stalled(port, FROM_BOARD)) {
    return;
  }
  chip_timer_stop(&port->silence);
  size_t given = port->pty->open ? pty_write(port->pty, port->received, port->received_count) : 0;
  port->bytes_delivered += given;
  port->bytes_lost += port->received_count - given;
  port->received_count = 0;
}

static void on_silence(void *owner) { deliver_received(owner); }

static void on_received(void *owner, uint8_t byte, bool framing_error) {
  struct host_port *port = owner;
  port->framing_errors += framing_error;
  if (port->received_count == HOST_BYTES_MAX) {
    port->bytes_lost++;
    return;
  }
  port->received[port->received_count++] = byte;
  if (port->received_count >= HOST_CHUNK_BYTES) {
    deliver_received(port);
  } else {
    avr_cycle_count_t silence = (avr_cycle_count_t)(SILENCE_BITS * port->bit);
    chip_timer_start(&port->silence, chip_now(port->chip) + silence);
  }
}

static void send_next(void *owner) {
  struct host_port *port = owner;
  if (port->send_done < port->send_count && !stalled(port, TO_BOARD)) {
    double end = line_send(port->to_board, port->sending[port->send_done++], port->bit);
    chip_timer_start(&port->send_next, (avr_cycle_count_t)end);
  }
}

static void on_sending_stall_end(void *owner) {
  struct host_port *port = owner;
  if (!port->send_next.armed) {
    send_next(port);
  }
}

static void on_receiving_stall_end(void *owner) { deliver_received(owner); }

static void set_baud(struct host_port *port, unsigned baud) {
  port->baud = baud;
  port->bit = (double)CHIP_FREQUENCY / baud;
  port->to_host.receiver_bit = port->bit;
}

void host_port_create(struct host_port *port, struct chip *chip, struct pty *pty, struct line *to_board) {
  *port = (struct host_port){.chip = chip, .pty = pty, .to_board = to_board};
  line_create(&port->to_host, chip, 0, on_received, port);
  set_baud(port, pty_baud(pty));
  chip_timer_add(chip, &port->send_next, send_next, port);
  chip_timer_add(chip, &port->silence, on_silence, port);
  chip_timer_add(chip, &port->stall_ends[TO_BOARD], on_sending_stall_end, port);
  chip_timer_add(chip, &port->stall_ends[FROM_BOARD], on_receiving_stall_end, port);
  host_port_seed(port, 0);
}

bool host_port_has_room(const struct host_port *port) {
  return port->send_count - port->send_done < HOST_BYTES_MAX;
}

struct line *host_port_line(struct host_port *port, enum direction direction) {
  return direction == TO_BOARD ? port->to_board : &port->to_host;
}

void host_port_seed(struct host_port *port, uint64_t seed) {
  for (unsigned i = 0; i < DIRECTION_COUNT; i++) {
    line_faults_seed(&host_port_line(port, (enum direction)i)->faults, DIRECTION_COUNT * seed + i);
  }
}

void host_port_stall(struct host_port *port, enum direction direction, double seconds) {
  struct chip_timer *end = &port->stall_ends[direction];
  if (seconds > 0) {
    port->stalls[direction]++;
    chip_timer_start(end, chip_now(port->chip) + chip_cycles(seconds));
  } else if (end->armed) {
    chip_timer_stop(end);
    end->fire(port);
  }
}

bool host_port_busy(const struct host_port *port) {
  return port->send_next.armed || port->to_board->receiving || port->to_host.receiving || port->silence.armed;
}

void host_port_drop(struct host_port *port) {
  pty_drop(port->pty);
  port->send_count = port->send_done = 0;
  chip_timer_stop(&port->send_next);
  line_clear(port->to_board);
}

void host_port_serve(struct host_port *port) {
  unsigned baud = pty_baud(port->pty);
  if (baud != port->baud) {
    set_baud(port, baud);
  }
  size_t waiting = port->send_count - port->send_done;
  if (port->send_done) {
    memmove(port->sending, port->sending + port->send_done, waiting);
    port->send_done = 0;
  }
  size_t taken = pty_read(port->pty, port->sending + waiting, HOST_BYTES_MAX - waiting);
  port->send_count = waiting + taken;
  port->bytes_taken += taken;
  if (taken && !port->send_next.armed) {
    chip_timer_start(&port->send_next, chip_now(port->chip));
  }
}
