// SPDX-License-Identifier: GPL-3.0-or-later
#include "options.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "mistakes.h"

#define SPEED_MAX 1000.0
#define LINGER_MAX 86400.0
#define USAGE_ERROR 2

static const char usage[] =
    "usage: board --elf FILE --tty LINK --socket PATH [options]\n"
    "       board --bootloader FILE --tty LINK --socket PATH [options]\n"
    "Runs the firmware on an emulated board; LINK is its serial port, PATH its socket for water and "
    "commands.\n"
    "  --elf FILE        the program in its flash memory\n"
    "  --bootloader FILE an Intel HEX file with a boot loader, which runs after every reset\n"
    "  --speed X         emulated seconds in a real one, 1 by default; 0: as fast as possible\n"
    "  --paused          time passes only by the command `run`\n"
    "  --eeprom FILE     store the EEPROM in this file\n"
    "  --uncalibrated    begin without a calibration in the EEPROM, if it keeps none\n"
    "  --mistake NAME    a mistake of wiring or an imperfection of a part, from the list below; can be "
    "repeated\n"
    "  --reset-on-open   opening the serial port resets the board\n"
    "  --with-parent     end when the parent process ends\n"
    "  --server-lock FILE  end when no server has held this file's lock ...\n"
    "  --linger SECONDS    ... for that time, 30 by default\n"
    "\n"
    "Mistakes:\n";

enum choice {
  ELF,
  BOOTLOADER,
  TTY,
  SOCKET,
  SPEED,
  PAUSED,
  EEPROM,
  UNCALIBRATED,
  MISTAKE,
  RESET_ON_OPEN,
  WITH_PARENT,
  SERVER_LOCK,
  LINGER,
  HELP
};

static const struct option long_options[] = {
    {"elf", required_argument, NULL, ELF},
    {"bootloader", required_argument, NULL, BOOTLOADER},
    {"tty", required_argument, NULL, TTY},
    {"socket", required_argument, NULL, SOCKET},
    {"speed", required_argument, NULL, SPEED},
    {"paused", no_argument, NULL, PAUSED},
    {"eeprom", required_argument, NULL, EEPROM},
    {"uncalibrated", no_argument, NULL, UNCALIBRATED},
    {"mistake", required_argument, NULL, MISTAKE},
    {"reset-on-open", no_argument, NULL, RESET_ON_OPEN},
    {"with-parent", no_argument, NULL, WITH_PARENT},
    {"server-lock", required_argument, NULL, SERVER_LOCK},
    {"linger", required_argument, NULL, LINGER},
    {"help", no_argument, NULL, HELP},
    {NULL, 0, NULL, 0},
};

static void refuse(const char *what) {
  fprintf(stderr, "board: %s; see `board --help`\n", what);
  exit(USAGE_ERROR);
}

static double read_number(const char *text, double maximum, const char *refusal) {
  char *end;
  double number = strtod(text, &end);
  if (end == text || *end || !(number >= 0 && number <= maximum)) {
    refuse(refusal);
  }
  return number;
}

static void add_mistake(struct options *options, const char *text) {
  if (!mistakes_add(&options->wiring, text)) {
    char refusal[128];
    snprintf(refusal, sizeof refusal, "there is no mistake '%s'", text);
    refuse(refusal);
  }
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
      options->speed = read_number(optarg, SPEED_MAX, "--speed takes a number from 0 to 1000");
      break;
    case PAUSED:
      options->paused = true;
      break;
    case EEPROM:
      options->eeprom = optarg;
      break;
    case UNCALIBRATED:
      options->uncalibrated = true;
      break;
    case MISTAKE:
      add_mistake(options, optarg);
      break;
    case RESET_ON_OPEN:
      options->reset_on_open = true;
      break;
    case WITH_PARENT:
      options->with_parent = true;
      break;
    case SERVER_LOCK:
      options->server_lock = optarg;
      break;
    case LINGER:
      options->linger = read_number(optarg, LINGER_MAX, "--linger takes a number from 0 to 86400");
      break;
    case HELP:
      fputs(usage, stdout);
      fputs(mistakes_usage, stdout);
      exit(0);
    default:
      exit(USAGE_ERROR);  // getopt has printed the reason
  }
}

struct options options_read(int count, char **arguments) {
  struct options options = {.speed = 1, .linger = 30, .wiring = RIGHT_WIRING};
  for (int option; (option = getopt_long(count, arguments, "", long_options, NULL)) != -1;) {
    take(&options, option);
  }
  if (optind < count) {
    refuse("unexpected argument");
  }
  if (!(options.elf || options.bootloader) || !options.tty || !options.socket) {
    refuse("--elf or --bootloader, --tty and --socket are needed");
  }
  return options;
}
