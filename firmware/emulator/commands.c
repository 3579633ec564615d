// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mistakes.h"
#include "service.h"

#define RUN_MAX 86400.0   // s
#define STALL_MAX 3600.0  // s
#define STATS_MAX (CLIENT_LINE_MAX / 2)

static const char *const directions[] = {[TO_BOARD] = "to_board", [FROM_BOARD] = "from_board"};

struct command {
  const char *name;
  void (*act)(struct service *service, struct client *client, char *argument);
};

static void refuse(struct service *service, struct client *client, const char *reason) {
  clients_send(&service->clients, client, "error %s", reason);
}

static void send_ok(struct service *service, struct client *client) {
  clients_send(&service->clients, client, "ok");
}

// The text as a number; NaN if it is not exactly one number.
static double number(const char *text) {
  char *end;
  double value = strtod(text, &end);
  return end == text || *end ? NAN : value;
}

// The cycle from which a run counts. A run ends within the instruction that reaches its end. Counting from
// the planned end makes many short runs as long as one long run. A run whose client disconnected ended
// earlier.
static avr_cycle_count_t present(const struct service *service) {
  avr_cycle_count_t now = chip_now(&service->board.chip);
  return service->options->paused && service->run_until < now ? service->run_until : now;
}

static void attach(struct service *service, struct client *client, char *period) {
  if (service->water.client && service->water.client != client) {
    refuse(service, client, "another connection is the water");
  } else if (!water_attach(&service->water, client, number(period), present(service))) {
    refuse(service, client, "attach takes a period from 0.0005 to 1 s");
  }
}

static void sense(struct service *service, struct client *client, char *numbers) {
  if (service->water.client && service->water.client != client) {
    refuse(service, client, "another connection is the water");
  } else if (!water_sense(&service->water, numbers)) {
    refuse(
        service, client,
        "sense takes eleven finite numbers, pressure and battery not negative; perhaps four more, up to pi "
        "or nan; and perhaps one more, not negative");
  }
}

static void fins(struct service *service, struct client *client, char *nothing) {
  (void)nothing;
  water_send_fins(&service->water, client, "ok");
}

static void reset(struct service *service, struct client *client, char *nothing) {
  (void)nothing;
  chip_reset(&service->board.chip, CHIP_RESET_PIN);
  send_ok(service, client);
}

static void brown_out(struct service *service, struct client *client, char *lost) {
  double share = number(lost);
  if (!(share >= 0 && share <= 1)) {
    refuse(service, client, "brownout takes the share of the memory that is lost, 0 to 1");
    return;
  }
  chip_brown_out(&service->board.chip, share);
  send_ok(service, client);
}

static void power(struct service *service, struct client *client, char *nothing) {
  (void)nothing;
  if (service->runner) {
    refuse(service, client, "a run is already active");
    return;
  }
  service_power(service);
  send_ok(service, client);
}

static void load(struct service *service, struct client *client, char *path) {
  char reason[CLIENT_LINE_MAX];
  if (!chip_load(&service->board.chip, path, reason, sizeof reason / 2)) {
    refuse(service, client, reason);
    return;
  }
  reset(service, client, path);
}

static void run(struct service *service, struct client *client, char *seconds) {
  double duration = number(seconds);
  if (!service->options->paused) {
    refuse(service, client, "run needs a board that was started with --paused");
  } else if (service->runner) {
    refuse(service, client, "a run is already active");
  } else if (!(duration > 0 && duration <= RUN_MAX)) {
    refuse(service, client, "run takes a number of seconds, up to a day");
  } else {
    service->runner = client;
    service->run_until = present(service) + chip_cycles(duration);
  }
}

static void format_line_faults(struct service *service, char *text) {
  size_t length = 0;
  for (unsigned i = 0; i < DIRECTION_COUNT; i++) {
    struct host_port *port = &service->board.host;
    const struct line_fault_counts *counts = &host_port_line(port, (enum direction)i)->faults.counts;
    const char *name = directions[i];
    length += (size_t)snprintf(
        text + length, STATS_MAX - length,
        " %s_bit_errors=%lu %s_drops=%lu %s_doubles=%lu %s_inserts=%lu %s_bursts=%lu %s_burst_errors=%lu "
        "%s_cuts=%lu %s_stalls=%lu",
        name, counts->bit_errors, name, counts->drops, name, counts->doubles, name, counts->inserts, name,
        counts->bursts, name, counts->burst_errors, name, counts->cuts, name, port->stalls[i]);
  }
}

static void stats(struct service *service, struct client *client, char *nothing) {
  (void)nothing;
  const struct board *board = &service->board;
  double time = chip_seconds(chip_now(&board->chip));
  char faults[STATS_MAX];
  format_line_faults(service, faults);
  double speed_x = service->busy > 0 ? time / service->busy : 0;
  clients_send(&service->clients, client,
               "stats time=%.6f cycles=%llu speed_x=%.2f late=%lu skipped=%.3f sense_late=%lu resets=%lu "
               "watchdog_resets=%lu crashes=%lu baud_host=%u baud_board=%.0f bytes_from_host=%lu "
               "bytes_to_board=%lu framing_errors_board=%lu overruns=%lu bytes_from_board=%lu "
               "bytes_to_host=%lu bytes_lost=%lu framing_errors_host=%lu "
               "waiting=%zu%s",
               time, (unsigned long long)chip_now(&board->chip), speed_x, service->pace.late,
               service->pace.skipped, service->water.late, board->chip.resets, board->chip.watchdog_resets,
               board->chip.crashes, board->host.baud, CHIP_FREQUENCY / uart_bit(&board->uart),
               board->host.bytes_taken, board->uart.bytes_received, board->uart.framing_errors,
               board->uart.overruns, board->uart.bytes_sent, board->host.bytes_delivered,
               board->host.bytes_lost, board->host.framing_errors,
               board->host.send_count - board->host.send_done, faults);
}

static void fault(struct service *service, struct client *client, char *arguments) {
  char *kind = strchr(arguments, ' ');
  if (kind) {
    *kind++ = 0;
  }
  struct board *board = &service->board;
  bool bus = !strcmp(arguments, "i2c");
  if (kind &&
      (bus ? twi_set_fault(&board->twi, kind) : devices_set_fault(&board->devices, arguments, kind))) {
    pins_update_inputs(&board->pins);
    send_ok(service, client);
    return;
  }
  refuse(service, client,
         "fault takes imu, pressure, encoder0-3 or bridge0-3, and none, absent or stuck; weak for encoders, "
         "tripped for bridges, dip for the imu; or leak, and none or wet; or i2c, and none, stuck, refused, "
         "stretched or contested");
}

static void mistake(struct service *service, struct client *client, char *text) {
  struct wiring wiring = service->board.devices.wiring;
  bool none = !strcmp(text, "none");
  if (none) {
    wiring = (struct wiring)RIGHT_WIRING;
  } else if (!mistakes_add(&wiring, text)) {
    refuse(service, client, "there is no such mistake; `board --help` lists them");
    return;
  }
  board_set_wiring(&service->board, &wiring);
  send_ok(service, client);
}

static void turn(struct service *service, struct client *client, char *arguments) {
  char *angle = strchr(arguments, ' ');
  if (angle) {
    *angle++ = 0;
  }
  double fin = number(arguments), radians = angle ? number(angle) : NAN;
  if (!(fin >= 0 && fin < FIN_COUNT && fin == floor(fin) && radians >= -M_PI && radians <= M_PI)) {
    refuse(service, client, "turn takes a fin, 0 to 3, and an angle from -pi to pi");
    return;
  }
  motors_turn_by_hand(&service->board.devices.motors, (unsigned)fin, radians);
  send_ok(service, client);
}

static bool disturb(struct host_port *port, enum direction direction, const char *kind, const char *value) {
  bool clean = !strcmp(kind, "clean");
  if (!strcmp(kind, "stall")) {
    double seconds = number(value);
    bool valid = seconds >= 0 && seconds <= STALL_MAX;
    if (valid) {
      host_port_stall(port, direction, seconds);
    }
    return valid;
  }
  bool valid = line_faults_set(&host_port_line(port, direction)->faults, kind, value);
  if (valid && clean) {
    host_port_stall(port, direction, 0);
  }
  return valid;
}

// The first word of a text; `text` becomes the rest.
static char *next_word(char **text) {
  char *word = *text;
  *text += strcspn(word, " ");
  if (**text) {
    *(*text)++ = 0;
  }
  return word;
}

static void line(struct service *service, struct client *client, char *arguments) {
  const char *name = next_word(&arguments), *kind = next_word(&arguments);
  for (unsigned i = 0; i < DIRECTION_COUNT; i++) {
    if (!strcmp(name, directions[i]) && disturb(&service->board.host, (enum direction)i, kind, arguments)) {
      send_ok(service, client);
      return;
    }
  }
  refuse(service, client,
         "line takes to_board or from_board, and bit_errors, drop, double or insert with a rate from 0 to 1, "
         "burst with a rate and a length in bits, stall with seconds up to an hour, cut with on or off, or "
         "clean");
}

static void seed(struct service *service, struct client *client, char *text) {
  char *end;
  unsigned long long value = strtoull(text, &end, 10);
  if (*text < '0' || *text > '9' || *end) {
    refuse(service, client, "seed takes a whole number, not negative");
    return;
  }
  host_port_seed(&service->board.host, value);
  send_ok(service, client);
}

static void quit(struct service *service, struct client *client, char *nothing) {
  (void)client, (void)nothing;
  service->quitting = true;
}

static const struct command commands[] = {
    {"attach", attach}, {"sense", sense}, {"fins", fins},       {"reset", reset},        {"power", power},
    {"load", load},     {"run", run},     {"stats", stats},     {"fault", fault},        {"line", line},
    {"seed", seed},     {"quit", quit},   {"mistake", mistake}, {"brownout", brown_out}, {"turn", turn},
};

void commands_run(void *owner, struct client *client, char *line) {
  char *argument = strchr(line, ' ');
  if (argument) {
    *argument++ = 0;
  }
  for (unsigned i = 0; i < sizeof commands / sizeof *commands; i++) {
    if (!strcmp(line, commands[i].name)) {
      commands[i].act(owner, client, argument ? argument : line + strlen(line));
      return;
    }
  }
  refuse(owner, client, "unknown command");
}
