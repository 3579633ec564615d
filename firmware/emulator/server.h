// SPDX-License-Identifier: GPL-3.0-or-later
// Whether there is still a server to run for. A killed one that is started again finds the board running.
#ifndef SERVER_H
#define SERVER_H

#include <stdbool.h>

struct server {
  const char *lock;  // NULL: none is needed
  double linger;     // s
  double seen;       // s of real time
  double look_at;
};

void server_watch(struct server *server, const char *lock, double linger, double now);

// Checks twice a second, at most. True where none has held the lock for longer than `linger`, or the file is
// gone.
bool server_gone(struct server *server, double now);

#endif
