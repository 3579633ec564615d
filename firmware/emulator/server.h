// SPDX-License-Identifier: GPL-3.0-or-later
// The check for a running server. A killed server that restarts in time finds the board running.
#ifndef SERVER_H
#define SERVER_H

#include <stdbool.h>

struct server {
  const char *lock;  // NULL: no server is needed
  double linger;     // s
  double seen;       // s of real time
  double check_at;
};

void server_watch(struct server *server, const char *lock, double linger, double now);

// Checks at most twice a second. True if no server has held the lock for longer than `linger`, or the file is
// gone.
bool server_gone(struct server *server, double now);

#endif
