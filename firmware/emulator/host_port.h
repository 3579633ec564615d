// SPDX-License-Identifier: GPL-3.0-or-later
// The host's serial port as the Raspberry Pi's PL011 would be: it sends and samples at the speed that the
// host has set, and hands over what it received eight bytes at a time, or after 32 bit times of silence.
#ifndef HOST_PORT_H
#define HOST_PORT_H

#include "chip.h"
#include "line.h"
#include "pty.h"

#define HOST_BYTES_MAX 4096  // as much as Linux keeps for a serial port, each way
#define HOST_CHUNK_BYTES 8

enum direction { TO_BOARD, FROM_BOARD, DIRECTION_COUNT };

struct host_port {
  struct chip *chip;
  struct pty *pty;
  struct line *to_board;
  struct line to_host;
  double bit;  // cycles
  unsigned baud;
  uint8_t sending[HOST_BYTES_MAX];
  size_t send_count, send_done;
  uint8_t received[HOST_BYTES_MAX];
  size_t received_count;
  struct chip_timer send_next, silence;
  struct chip_timer stall_ends[DIRECTION_COUNT];
  unsigned long stalls[DIRECTION_COUNT];
  unsigned long bytes_taken;  // from the host
  unsigned long bytes_given;  // to the host
  unsigned long
      bytes_lost;  // because the host had closed the port, or did not read it, or it stalled for too long
  unsigned long framing_errors;  // as the host sees them
};

void host_port_create(struct host_port *port, struct chip *chip, struct pty *pty, struct line *to_board);

// Whether more from the host can be taken in.
bool host_port_has_room(const struct host_port *port);

// The line in this direction.
struct line *host_port_line(struct host_port *port, enum direction direction);

// From now on the faults of both directions follow from this number.
void host_port_seed(struct host_port *port, uint64_t seed);

// Takes or gives nothing for this long; 0 ends a stall. Nothing gets lost, up to HOST_BYTES_MAX.
void host_port_stall(struct host_port *port, enum direction direction, double seconds);

// Whether there is something on the line, either way, or about to be handed over.
bool host_port_busy(const struct host_port *port);

// Takes over the speed that the host has set, and what it has written.
void host_port_serve(struct host_port *port);

#endif
