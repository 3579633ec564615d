// SPDX-License-Identifier: GPL-3.0-or-later
// The pseudo-terminal that the host opens as its serial port, under a chosen name.
#ifndef PTY_H
#define PTY_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct pty {
  int master;
  char device[64];
  char link[PATH_MAX];
  int watch;       // inotify of openings and closings
  unsigned users;  // open file descriptions, as far as they were read from `watch`
  bool open;       // true if the host has it open
};

// False with a reason if the link cannot be created.
bool pty_create(struct pty *pty, const char *link, char *reason, size_t reason_size);
void pty_remove(struct pty *pty);

// Checks if the host has opened or closed it; true if it has been opened since the last call, also where it
// was closed and opened again in between.
bool pty_check(struct pty *pty);

// Drops what the host has written.
void pty_drop(struct pty *pty);

unsigned pty_baud(const struct pty *pty);

// Both return the number of bytes; 0 if none can be read or written at the moment.
size_t pty_read(struct pty *pty, uint8_t *bytes, size_t size);
size_t pty_write(struct pty *pty, const uint8_t *bytes, size_t size);

#endif
