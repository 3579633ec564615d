// SPDX-License-Identifier: GPL-3.0-or-later
#include "service.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <sys/signalfd.h>
#include <time.h>
#include <unistd.h>

#include "commands.h"

#define SLICE 1e-3           // s of real time between two checks of the clock
#define LINE_SLICE 0.2e-3    // the same while bytes are on the serial line
#define UNPACED_SLICE 5e-3   // s of emulated time between two checks of port and socket
#define WATER_TIMEOUT 50e-3  // s

enum { POLL_SIGNALS, POLL_PTY, POLL_CLIENTS, POLL_COUNT = POLL_CLIENTS + CLIENTS_POLLS };

static bool paced(const struct service *service) {
  return !service->options->paused && service->options->speed > 0;
}

static int open_signals(void) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGUSR1);
  sigprocmask(SIG_BLOCK, &set, NULL);
  return signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
}

static void on_disconnect(void *owner, struct client *client) {
  struct service *service = owner;
  water_disconnect(&service->water, client);
  if (client == service->runner) {
    service->runner = NULL;
  }
}

bool service_create(struct service *service, const struct options *options, char *reason,
                    size_t reason_size) {
  service->options = options;
  service->signals = open_signals();
  service->clients.on_line = commands_run;
  service->clients.on_disconnect = on_disconnect;
  service->clients.owner = service;
  if (!clients_listen(&service->clients, options->socket, reason, reason_size)) {
    return false;
  }
  struct board *board = &service->board;
  bool ready = pty_create(&service->pty, options->tty, reason, reason_size);
  if (ready && !board_create(board, &service->pty)) {
    snprintf(reason, reason_size, "libsimavr knows no ATmega328P");
    ready = false;
  }
  ready = ready &&
          (!options->bootloader ||
           chip_load_bootloader(&board->chip, options->bootloader, reason, reason_size)) &&
          (!options->elf || chip_load(&board->chip, options->elf, reason, reason_size)) &&
          (!options->eeprom || eeprom_open(&board->eeprom, options->eeprom, reason, reason_size));
  if (ready && !options->uncalibrated) {
    eeprom_calibrate(&board->eeprom);
  }
  if (!ready) {
    service_remove(service);
    return false;
  }
  board_set_wiring(board, &options->wiring);
  water_create(&service->water, board, &service->clients, paced(service) ? WATER_TIMEOUT : INFINITY);
  chip_reset(&board->chip, CHIP_POWER_ON);
  pace_start(&service->pace, options->speed, pace_clock(), chip_now(&board->chip));
  server_watch(&service->server, options->server_lock, options->linger, pace_clock());
  return true;
}

void service_power(struct service *service) {
  struct board *board = &service->board;
  struct water *water = &service->water;
  struct client *client = water->client;
  double period = chip_seconds(water->period);
  if (!board_power_cycle(board)) {
    service->quitting = true;
    return;
  }
  water_create(water, board, &service->clients, water->timeout);
  if (client) {
    water_attach(water, client, period, chip_now(&board->chip));
  }
  service->busy = 0;
  service->run_until = 0;
  chip_reset(&board->chip, CHIP_POWER_ON);
  pace_start(&service->pace, service->options->speed, pace_clock(), chip_now(&board->chip));
}

void service_remove(struct service *service) {
  pty_remove(&service->pty);
  clients_close(&service->clients);
  close(service->signals);
}

static avr_cycle_count_t target(struct service *service, double now) {
  avr_cycle_count_t cycle = chip_now(&service->board.chip);
  if (paced(service)) {
    return pace_target(&service->pace, now, cycle);
  }
  avr_cycle_count_t slice = cycle + chip_cycles(UNPACED_SLICE);
  if (!service->options->paused) {
    return slice;
  }
  if (!service->runner) {
    return cycle;
  }
  return slice < service->run_until ? slice : service->run_until;
}

static void advance(struct service *service) {
  struct chip *chip = &service->board.chip;
  double start = pace_clock();
  if (water_waiting(&service->water, start)) {
    return;
  }
  avr_cycle_count_t until = target(service, start);
  if (until > chip_now(chip)) {
    chip_run(chip, until);
    double end = pace_clock();
    service->busy += end - start;
    water_request(&service->water, end);
  }
  bool done = !service->water.waiting && service->runner && chip_now(chip) >= service->run_until;
  if (done) {
    struct client *runner = service->runner;
    service->runner = NULL;
    clients_send(&service->clients, runner, "ok %.6f", chip_seconds(chip_now(chip)));
  }
}

// s until the next work; infinity if only an event can bring work.
static double idle_time(const struct service *service) {
  double idle = INFINITY;
  if (service->water.waiting) {
    idle = service->water.wait_until - pace_clock();
  } else if (paced(service)) {
    idle = host_port_busy(&service->board.host) ? LINE_SLICE : SLICE;
  } else if (!service->options->paused || service->runner) {
    idle = 0;
  }
  return fmax(idle, 0);
}

static void wait_for_events(struct service *service, struct pollfd polls[POLL_COUNT]) {
  const struct pty *pty = &service->pty;
  polls[POLL_SIGNALS] = (struct pollfd){.fd = service->signals, .events = POLLIN};
  short events = host_port_has_room(&service->board.host) ? POLLIN : 0;
  polls[POLL_PTY] = (struct pollfd){.fd = pty->open ? pty->master : -1, .events = events};
  clients_watch(&service->clients, &polls[POLL_CLIENTS]);
  double idle = idle_time(service);
  struct timespec timeout = {.tv_sec = 0, .tv_nsec = isfinite(idle) ? (long)(idle * 1e9) : 0};
  if (ppoll(polls, POLL_COUNT, isfinite(idle) ? &timeout : NULL, NULL) <= 0) {
    for (unsigned i = 0; i < POLL_COUNT; i++) {
      polls[i].revents = 0;
    }
  }
}

static void serve_port(struct service *service) {
  bool opened = pty_check(&service->pty);
  if (opened && service->options->reset_on_open) {
    host_port_drop(&service->board.host);
    chip_reset(&service->board.chip, CHIP_RESET_PIN);
  }
  if (service->pty.open) {
    host_port_serve(&service->board.host);
  }
}

static void serve_signals(struct service *service) {
  struct signalfd_siginfo signal;
  while (read(service->signals, &signal, sizeof signal) == sizeof signal) {
    if (signal.ssi_signo == SIGUSR1) {
      chip_reset(&service->board.chip, CHIP_RESET_PIN);
    } else {
      service->quitting = true;
    }
  }
}

void service_run(struct service *service) {
  while (!service->quitting && !server_gone(&service->server, pace_clock())) {
    struct pollfd polls[POLL_COUNT];
    wait_for_events(service, polls);
    if (paced(service)) {
      advance(service);  // so that new input arrives now and not a slice ago
    }
    if (polls[POLL_SIGNALS].revents) {
      serve_signals(service);
    }
    clients_serve(&service->clients, &polls[POLL_CLIENTS]);
    serve_port(service);
    if (!paced(service)) {
      advance(service);
    }
  }
}
