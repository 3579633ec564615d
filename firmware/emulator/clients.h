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
  int socket;  // -1: not connected
  char text[CLIENT_LINE_MAX];
  size_t length;
};

struct clients {
  int listener;
  struct sockaddr_un address;
  struct client list[CLIENTS_MAX];
  void (*on_line)(void *owner, struct client *client, char *line);
  void (*on_disconnect)(void *owner, struct client *client);
  void *owner;
};

// False with a reason if the socket cannot be opened.
bool clients_listen(struct clients *clients, const char *path, char *reason, size_t reason_size);
void clients_close(struct clients *clients);

// Sets up the events to wait for, and handles them; both use CLIENTS_POLLS entries.
void clients_watch(const struct clients *clients, struct pollfd *polls);
void clients_serve(struct clients *clients, const struct pollfd *polls);

// Sends a line, given without its end; disconnects a client that does not read.
__attribute__((format(printf, 3, 4))) void clients_send(struct clients *clients, struct client *client,
                                                        const char *format, ...);

#endif
