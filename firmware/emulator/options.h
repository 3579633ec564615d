// SPDX-License-Identifier: GPL-3.0-or-later
// The command line.
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>

#include "wiring.h"

struct options {
  const char *elf;         // NULL: the flash memory is empty
  const char *bootloader;  // NULL: the chip starts with the program
  const char *tty;
  const char *socket;
  const char *eeprom;    // NULL: it is lost at the end
  double speed;          // emulated seconds in a real one; 0: as fast as it goes
  bool paused;           // time passes only by the command `run`
  struct wiring wiring;  // with the mistakes of the command line
  bool uncalibrated;
  bool reset_on_open;
  bool with_parent;
  const char *server_lock;  // NULL: no server is needed
  double linger;            // s without one
};

// Ends the process if the command line is wrong or asks for help.
struct options options_read(int count, char **arguments);

#endif
