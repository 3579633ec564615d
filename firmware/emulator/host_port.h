// SPDX-License-Identifier: GPL-3.0-or-later
// The host's serial port, like the Raspberry Pi's PL011: it sends and samples at the host's speed, and
// delivers received bytes eight at a time, or after 32 bit times of silence.
#ifndef HOST_PORT_H
#define HOST_PORT_H

#include "chip.h"
#include "line.h"
#include "pty.h"

#define HOST_BYTES_MAX 4096  // as much as Linux buffers for a serial port, each way
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
  unsigned long bytes_taken;      // from the host
  unsigned long bytes_delivered;  // to the host
  unsigned long bytes_lost;       // the host had closed the port or did not read it, or a stall was too long
  unsigned long framing_errors;   // as the host sees them
};

void host_port_create(struct host_port *port, struct chip *chip, struct pty *pty, struct line *to_board);

// True if there is room for more bytes from the host.
bool host_port_has_room(const struct host_port *port);

// The line in this direction.
struct line *host_port_line(struct host_port *port, enum direction direction);

// Sets the seed of the faults of both directions.
void host_port_seed(struct host_port *port, uint64_t seed);

// Stops one direction for this long; 0 ends a stall. Up to HOST_BYTES_MAX bytes are buffered.
void host_port_stall(struct host_port *port, enum direction direction, double seconds);

// True if bytes are on the line, either way, or wait for delivery.
bool host_port_busy(const struct host_port *port);

// Drops what the host has written and the board has not received; a real adapter sends it before the host can
// open the port again.
void host_port_drop(struct host_port *port);

// Reads the host's speed setting, and the bytes it has written.
void host_port_serve(struct host_port *port);

#endif
