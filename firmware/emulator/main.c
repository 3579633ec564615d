// SPDX-License-Identifier: GPL-3.0-or-later
// µ-CAT's emulated board: the compiled firmware on an emulated ATmega328P, behind a pseudo-terminal.
//
// Copyright (C) the µ-CAT contributors
//
// This program is free software: you can redistribute it and/or modify it under the terms of the GNU General
// Public License as published by the Free Software Foundation, either version 3 of the License, or (at your
// option) any later version. It is distributed in the hope that it will be useful, but without any warranty;
// without even the implied warranty of merchantability or fitness for a particular purpose. See the GNU
// General Public License, in LICENSE, for more details. It is under this licence because it links libsimavr.
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "options.h"
#include "service.h"

#define REASON_SIZE 4608

int main(int count, char **arguments) {
  pid_t parent = getppid();
  struct options options = options_read(count, arguments);
  if (options.with_parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) {
      return 0;
    }
  }
  static struct service service;
  char reason[REASON_SIZE];
  if (!service_create(&service, &options, reason, sizeof reason)) {
    fprintf(stderr, "board: %s\n", reason);
    return 1;
  }
  puts("ready");
  fflush(stdout);
  service_run(&service);
  service_remove(&service);
  return 0;
}
