// SPDX-License-Identifier: GPL-3.0-or-later
// The board as a process: runs the chip, and serves the serial port and the socket.
#ifndef SERVICE_H
#define SERVICE_H

#include "board.h"
#include "clients.h"
#include "options.h"
#include "pace.h"
#include "server.h"
#include "water.h"

struct service {
  const struct options *options;
  struct board board;
  struct pty pty;
  struct clients clients;
  struct water water;
  struct pace pace;
  struct server server;
  int signals;            // a file descriptor for SIGTERM, SIGINT and SIGUSR1
  struct client *runner;  // the client that waits for the end of a `run`
  avr_cycle_count_t run_until;
  double busy;  // s of the host's time spent emulating
  bool quitting;
};

// False with a reason on failure.
bool service_create(struct service *service, const struct options *options, char *reason, size_t reason_size);

// Switches the board's power off and on. Time begins at 0; the water stays connected.
void service_power(struct service *service);

// Runs until `quit` or a signal.
void service_run(struct service *service);

// Removes the link and the socket.
void service_remove(struct service *service);

#endif
