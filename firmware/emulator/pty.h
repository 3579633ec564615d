// SPDX-License-Identifier: GPL-3.0-or-later
// The pseudo-terminal that the host opens as its serial port, under a name of our choice.
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
  bool open;  // whether the host has it open
};

// False with a reason where the link cannot be made.
bool pty_create(struct pty *pty, const char *link, char *reason, size_t reason_size);
void pty_remove(struct pty *pty);

// Looks whether the host has opened or closed it; true where it has just been opened.
bool pty_check(struct pty *pty);

unsigned pty_baud(const struct pty *pty);

// Both return the number of bytes, 0 where nothing can be had or given at the moment.
size_t pty_read(struct pty *pty, uint8_t *bytes, size_t size);
size_t pty_write(struct pty *pty, const uint8_t *bytes, size_t size);

#endif
