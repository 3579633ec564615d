// SPDX-License-Identifier: GPL-3.0-or-later
#include "pty.h"

#include <asm/termbits.h>  // and not termios.h: only this one knows of arbitrary speeds
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_BAUD 115200

// Without this it would echo the board's output until the host sets it up.
static bool make_raw(int master) {
  struct termios2 settings;
  if (ioctl(master, TCGETS2, &settings)) {
    return false;
  }
  settings.c_iflag = settings.c_oflag = settings.c_lflag = 0;
  settings.c_cflag = BOTHER | CS8 | CREAD | CLOCAL;
  settings.c_ispeed = settings.c_ospeed = FIRST_BAUD;
  return ioctl(master, TCSETS2, &settings) == 0;
}

static bool open_pair(struct pty *pty) {
  pty->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (pty->master < 0 || grantpt(pty->master) || unlockpt(pty->master) || !make_raw(pty->master) ||
      ptsname_r(pty->master, pty->device, sizeof pty->device)) {
    return false;
  }
  // Only after it was open once can a close be detected.
  int device = open(pty->device, O_RDWR | O_NOCTTY | O_CLOEXEC);
  return device >= 0 && close(device) == 0;
}

static bool watch(struct pty *pty) {
  pty->watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  return pty->watch >= 0 && inotify_add_watch(pty->watch, pty->device, IN_OPEN | IN_CLOSE) >= 0;
}

static bool make_link(const struct pty *pty, char *reason, size_t size) {
  struct stat status;
  if (lstat(pty->link, &status) == 0 && !S_ISLNK(status.st_mode)) {
    snprintf(reason, size, "%s exists and is not a link", pty->link);
    return false;
  }
  unlink(pty->link);
  if (symlink(pty->device, pty->link)) {
    snprintf(reason, size, "cannot create %s: %s", pty->link, strerror(errno));
    return false;
  }
  return true;
}

bool pty_create(struct pty *pty, const char *link, char *reason, size_t reason_size) {
  *pty = (struct pty){.master = -1, .watch = -1};
  if (strlen(link) >= sizeof pty->link) {
    snprintf(reason, reason_size, "the path of the serial port is too long");
    return false;
  }
  strcpy(pty->link, link);
  if (!open_pair(pty)) {
    snprintf(reason, reason_size, "cannot open a pseudo-terminal: %s", strerror(errno));
    return false;
  }
  if (!watch(pty)) {
    snprintf(reason, reason_size, "cannot watch the pseudo-terminal: %s", strerror(errno));
    return false;
  }
  return make_link(pty, reason, reason_size);
}

void pty_remove(struct pty *pty) {
  char target[sizeof pty->device];
  ssize_t length = readlink(pty->link, target, sizeof target - 1);
  if (length > 0) {
    target[length] = 0;
    if (!strcmp(target, pty->device)) {
      unlink(pty->link);
    }
  }
  close(pty->watch);
  close(pty->master);
}

// The terminal's state does not tell of a host that closed it and opened it again since the last look.
static bool was_opened(struct pty *pty) {
  struct inotify_event events[16];  // without names: a file is watched, and no folder
  bool opened = false;
  ssize_t size;
  while ((size = read(pty->watch, events, sizeof events)) > 0) {
    for (size_t i = 0; i < (size_t)size / sizeof *events; i++) {
      if (events[i].mask & IN_OPEN) {
        opened |= pty->users++ == 0;
      } else if (events[i].mask & IN_CLOSE && pty->users) {
        pty->users--;
      }
    }
  }
  return opened;
}

bool pty_check(struct pty *pty) {
  struct pollfd state = {.fd = pty->master, .events = POLLIN};
  poll(&state, 1, 0);
  // Bytes written before closing can still be read.
  pty->open = !(state.revents & POLLHUP) || state.revents & POLLIN;
  if (state.revents & POLLHUP) {
    pty->users = 0;  // equal events in succession are told as one
  }
  return was_opened(pty);
}

void pty_drop(struct pty *pty) {
  uint8_t bytes[256];
  while (pty_read(pty, bytes, sizeof bytes)) {
  }
}

unsigned pty_baud(const struct pty *pty) {
  struct termios2 settings;
  return ioctl(pty->master, TCGETS2, &settings) == 0 && settings.c_ospeed ? settings.c_ospeed : FIRST_BAUD;
}

size_t pty_read(struct pty *pty, uint8_t *bytes, size_t size) {
  ssize_t count = read(pty->master, bytes, size);
  return count > 0 ? (size_t)count : 0;
}

size_t pty_write(struct pty *pty, const uint8_t *bytes, size_t size) {
  ssize_t count = write(pty->master, bytes, size);
  return count > 0 ? (size_t)count : 0;
}
