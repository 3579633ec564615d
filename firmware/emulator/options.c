// SPDX-License-Identifier: GPL-3.0-or-later
#include "options.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SPEED_MAX 1000.0
#define USAGE_ERROR 2

static const char usage[] =
    "usage: board --elf FILE --tty LINK --socket PATH [options]\n"
    "       board --bootloader FILE --tty LINK --socket PATH [options]\n"
    "Runs the firmware on an emulated board; its serial port is at LINK, the water and commands at PATH.\n"
    "  --elf FILE        the program in its flash memory\n"
    "  --bootloader FILE an Intel HEX file with a boot loader, with which it starts after every reset\n"
    "  --speed X         emulated seconds in a real one, 1 by default; 0: as fast as it goes\n"
    "  --paused          time passes only when the command `run` says so\n"
    "  --eeprom FILE     keep the EEPROM in this file\n"
    "  --reset-on-open   opening the serial port resets the board\n"
    "  --with-parent     end when the parent process ends\n";

enum choice { ELF, BOOTLOADER, TTY, SOCKET, SPEED, PAUSED, EEPROM, RESET_ON_OPEN, WITH_PARENT, HELP };

static const struct option long_options[] = {
    {"elf", required_argument, NULL, ELF},
    {"bootloader", required_argument, NULL, BOOTLOADER},
    {"tty", required_argument, NULL, TTY},
    {"socket", required_argument, NULL, SOCKET},
    {"speed", required_argument, NULL, SPEED},
    {"paused", no_argument, NULL, PAUSED},
    {"eeprom", required_argument, NULL, EEPROM},
    {"reset-on-open", no_argument, NULL, RESET_ON_OPEN},
    {"with-parent", no_argument, NULL, WITH_PARENT},
    {"help", no_argument, NULL, HELP},
    {NULL, 0, NULL, 0},
};

static void refuse(const char *what) {
  fprintf(stderr, "board: %s; `board --help` tells more\n", what);
  exit(USAGE_ERROR);
}

static double read_speed(const char *text) {
  char *end;
  double speed = strtod(text, &end);
  if (end == text || *end || !(speed >= 0 && speed <= SPEED_MAX)) {
    refuse("--speed takes a number from 0 to 1000");
  }
  return speed;
}

static void take(struct options *options, int option) {
  switch (option) {
    case ELF:
      options->elf = optarg;
      break;
    case BOOTLOADER:
      options->bootloader = optarg;
      break;
    case TTY:
      options->tty = optarg;
      break;
    case SOCKET:
      options->socket = optarg;
      break;
    case SPEED:
      options->speed = read_speed(optarg);
      break;
    case PAUSED:
      options->paused = true;
      break;
    case EEPROM:
      options->eeprom = optarg;
      break;
    case RESET_ON_OPEN:
      options->reset_on_open = true;
      break;
    case WITH_PARENT:
      options->with_parent = true;
      break;
    case HELP:
      fputs(usage, stdout);
      exit(0);
    default:
      exit(USAGE_ERROR);  // getopt has said why
  }
}

struct options options_read(int count, char **arguments) {
  struct options options = {.speed = 1};
  for (int option; (option = getopt_long(count, arguments, "", long_options, NULL)) != -1;) {
    take(&options, option);
  }
  if (optind < count) {
    refuse("there is an argument too many");
  }
  if (!(options.elf || options.bootloader) || !options.tty || !options.socket) {
    refuse("--elf or --bootloader, --tty and --socket are needed");
  }
  return options;
}
