// SPDX-License-Identifier: GPL-3.0-or-later
#include "clients.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

static bool in_use(const struct sockaddr_un *address) {
  int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  bool answered = probe >= 0 && connect(probe, (const struct sockaddr *)address, sizeof *address) == 0;
  close(probe);
  return answered;
}

// Removes the socket of a board that was killed, and nothing else.
static bool clear_path(const struct sockaddr_un *address, char *reason, size_t size) {
  struct stat status;
  if (lstat(address->sun_path, &status)) {
    return true;
  }
  if (!S_ISSOCK(status.st_mode)) {
    snprintf(reason, size, "%s exists and is not a socket", address->sun_path);
    return false;
  }
  if (in_use(address)) {
    snprintf(reason, size, "another board answers at %s; end it, or choose another --socket",
             address->sun_path);
    return false;
  }
  unlink(address->sun_path);
  return true;
}

bool clients_listen(struct clients *clients, const char *path, char *reason, size_t reason_size) {
  clients->address = (struct sockaddr_un){.sun_family = AF_UNIX};
  for (unsigned i = 0; i < CLIENTS_MAX; i++) {
    clients->list[i].socket = -1;
  }
  if (strlen(path) >= sizeof clients->address.sun_path) {
    snprintf(reason, reason_size, "the socket's path is longer than %zu bytes; choose a shorter one",
             sizeof clients->address.sun_path - 1);
    return false;
  }
  strcpy(clients->address.sun_path, path);
  if (!clear_path(&clients->address, reason, reason_size)) {
    return false;
  }
  clients->listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (clients->listener < 0 ||
      bind(clients->listener, (const struct sockaddr *)&clients->address, sizeof clients->address) ||
      listen(clients->listener, CLIENTS_MAX)) {
    snprintf(reason, reason_size, "cannot listen at %s: %s", path, strerror(errno));
    return false;
  }
  return true;
}

static void disconnect(struct clients *clients, struct client *client) {
  close(client->socket);
  client->socket = -1;
  clients->on_disconnect(clients->owner, client);
}

void clients_close(struct clients *clients) {
  for (unsigned i = 0; i < CLIENTS_MAX; i++) {
    if (clients->list[i].socket >= 0) {
      close(clients->list[i].socket);
    }
  }
  close(clients->listener);
  unlink(clients->address.sun_path);
}

void clients_watch(const struct clients *clients, struct pollfd *polls) {
  for (unsigned i = 0; i < CLIENTS_MAX; i++) {
    polls[i] = (struct pollfd){.fd = clients->list[i].socket, .events = POLLIN};
  }
  polls[CLIENTS_MAX] = (struct pollfd){.fd = clients->listener, .events = POLLIN};
}

static void accept_client(struct clients *clients) {
  int socket = accept4(clients->listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket < 0) {
    return;
  }
  for (unsigned i = 0; i < CLIENTS_MAX; i++) {
    struct client *client = &clients->list[i];
    if (client->socket < 0) {
      client->socket = socket;
      client->length = 0;
      return;
    }
  }
  close(socket);
}

static void handle_lines(struct clients *clients, struct client *client) {
  char *start = client->text, *end;
  while (client->socket >= 0 && (end = memchr(start, '\n', client->length))) {
    *end = 0;
    size_t size = (size_t)(end + 1 - start);
    client->length -= size;
    clients->on_line(clients->owner, client, start);
    start = end + 1;
  }
  memmove(client->text, start, client->length);
}

static void receive(struct clients *clients, struct client *client) {
  if (client->length == sizeof client->text) {
    disconnect(clients, client);  // a line without an end
    return;
  }
  ssize_t count =
      recv(client->socket, client->text + client->length, sizeof client->text - client->length, 0);
  if (count > 0) {
    client->length += (size_t)count;
    handle_lines(clients, client);
  } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
    disconnect(clients, client);
  }
}

void clients_serve(struct clients *clients, const struct pollfd *polls) {
  for (unsigned i = 0; i < CLIENTS_MAX; i++) {
    struct client *client = &clients->list[i];
    if (client->socket >= 0 && client->socket == polls[i].fd && polls[i].revents) {
      receive(clients, client);
    }
  }
  if (polls[CLIENTS_MAX].revents) {
    accept_client(clients);
  }
}

void clients_send(struct clients *clients, struct client *client, const char *format, ...) {
  char line[CLIENT_LINE_MAX];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(line, sizeof line - 1, format, arguments);
  va_end(arguments);
  if (length < 0 || client->socket < 0) {
    return;
  }
  size_t size = (size_t)length < sizeof line - 2 ? (size_t)length : sizeof line - 2;
  line[size++] = '\n';
  if (send(client->socket, line, size, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)size) {
    disconnect(clients, client);
  }
}
