// SPDX-License-Identifier: GPL-3.0-or-later
// The commands on the socket; docs/reference/emulator.md lists them.
#ifndef COMMANDS_H
#define COMMANDS_H

#include "clients.h"

// Executes a command line and answers it; `service` is a struct service.
void commands_run(void *service, struct client *client, char *line);

#endif
