// SPDX-License-Identifier: GPL-3.0-or-later
// The board as a process: lets time pass for the chip and serves the serial port and the socket meanwhile.
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
  int signals;            // a file descriptor that tells of SIGTERM, SIGINT and SIGUSR1
  struct client *runner;  // who waits for the end of a `run`
  avr_cycle_count_t run_until;
  double busy;  // s of the host's time spent emulating
  bool quitting;
};

// False with a reason where something cannot be had.
bool service_create(struct service *service, const struct options *options, char *reason, size_t reason_size);

// Takes the board's power away and gives it back. Time begins anew; the water stays.
void service_power(struct service *service);

// Serves until it is asked to quit.
void service_run(struct service *service);

// Takes away the link and the socket.
void service_remove(struct service *service);

#endif
