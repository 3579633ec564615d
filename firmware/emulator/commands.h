// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that come over the socket; docs/reference/emulator.md lists them.
#ifndef COMMANDS_H
#define COMMANDS_H

#include "clients.h"

// Executes a command line and answers it; `service` is a struct service.
void commands_do(void *service, struct client *client, char *line);

#endif
