// SPDX-License-Identifier: GPL-3.0-or-later
#include "server.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#define CHECK_PERIOD 0.5  // s

void server_watch(struct server *server, const char *lock, double linger, double now) {
  *server = (struct server){.lock = lock, .linger = linger, .seen = now, .check_at = now};
}

bool server_gone(struct server *server, double now) {
  if (!server->lock || now < server->check_at) {
    return false;
  }
  server->check_at = now + CHECK_PERIOD;
  int file = open(server->lock, O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return true;
  }
  bool free = flock(file, LOCK_SH | LOCK_NB) == 0;
  close(file);
  if (!free) {
    server->seen = now;
    return false;
  }
  return now - server->seen >= server->linger;
}
