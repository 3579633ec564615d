// SPDX-License-Identifier: GPL-3.0-or-later
// The Unix socket: connections that exchange lines of text with the board.
#ifndef CLIENTS_H
#define CLIENTS_H

#include <poll.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/un.h>

#define CLIENTS_MAX 8
#define CLIENT_LINE_MAX 2048
#define CLIENTS_POLLS (CLIENTS_MAX + 1)

struct client {
  int socket;  // -1: nobody
  char text[CLIENT_LINE_MAX];
  size_t length;
};

struct clients {
  int listener;
  struct sockaddr_un address;
  struct client list[CLIENTS_MAX];
  void (*on_line)(void *owner, struct client *client, char *line);
  void (*on_gone)(void *owner, struct client *client);
  void *owner;
};

// False with a reason where the socket cannot be had.
bool clients_listen(struct clients *clients, const char *path, char *reason, size_t reason_size);
void clients_close(struct clients *clients);

// What to wait for, and what to do once it has come; both with CLIENTS_POLLS entries.
void clients_watch(const struct clients *clients, struct pollfd *polls);
void clients_serve(struct clients *clients, const struct pollfd *polls);

// Sends a line, given without its end; a client that does not read is sent away.
__attribute__((format(printf, 3, 4))) void clients_tell(struct clients *clients, struct client *client,
                                                        const char *format, ...);

#endif
