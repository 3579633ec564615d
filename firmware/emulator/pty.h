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
  bool open;  // true if the host has it open
};

// False with a reason if the link cannot be created.
bool pty_create(struct pty *pty, const char *link, char *reason, size_t reason_size);
void pty_remove(struct pty *pty);

// Checks if the host has opened or closed it; true if it has just been opened.
bool pty_check(struct pty *pty);

unsigned pty_baud(const struct pty *pty);

// Both return the number of bytes; 0 if none can be read or written at the moment.
size_t pty_read(struct pty *pty, uint8_t *bytes, size_t size);
size_t pty_write(struct pty *pty, const uint8_t *bytes, size_t size);

#endif
