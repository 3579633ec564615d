// SPDX-License-Identifier: GPL-3.0-or-later
#include "water.h"

#include <stdlib.h>
#include <string.h>

#define PERIOD_MIN 0.5e-3
#define PERIOD_MAX 1.0
#define NUMBERS_WITHOUT_ENCODERS 11
#define FIN_LOAD (SURROUNDINGS_NUMBERS - 1)

static void on_period(void *owner) {
  struct water *water = owner;
  chip_timer_start(&water->due, water->due.when + water->period);
  water->fins_due = true;
  chip_interrupt(&water->board->chip);
}

void water_create(struct water *water, struct board *board, struct clients *clients, double timeout) {
  *water = (struct water){.board = board, .clients = clients, .timeout = timeout};
  chip_timer_add(&board->chip, &water->due, on_period, water);
}

bool water_attach(struct water *water, struct client *client, double period, avr_cycle_count_t start) {
  if (!(period >= PERIOD_MIN && period <= PERIOD_MAX)) {
    return false;
  }
  water->client = client;
  water->period = chip_cycles(period);
  water->waiting = water->fins_due = false;
  chip_timer_start(&water->due, start + water->period);
  return true;
}

void water_disconnect(struct water *water, const struct client *client) {
  if (client == water->client) {
    water->client = NULL;
    water->waiting = water->fins_due = false;
    chip_timer_stop(&water->due);
  }
}

void water_send_fins(struct water *water, struct client *client, const char *word) {
  const struct board *board = water->board;
  const struct devices *devices = &board->devices;
  double angle[FIN_COUNT], speed[FIN_COUNT];
  int drive[FIN_COUNT];
  for (unsigned fin = 0; fin < FIN_COUNT; fin++) {
    angle[fin] = motors_fin_angle(&devices->motors, fin);
    speed[fin] = motors_fin_speed(&devices->motors, fin);
    drive[fin] = drv8830_drive(&devices->bridges[fin]);
  }
  clients_send(water->clients, client, "%s %.6f %.5f %.5f %.5f %.5f %.4f %.4f %.4f %.4f %d %d %d %d %d %d",
               word, chip_seconds(chip_now(&board->chip)), angle[0], angle[1], angle[2], angle[3], speed[0],
               speed[1], speed[2], speed[3], drive[0], drive[1], drive[2], drive[3], devices->motor_power,
               board->pins.led);
}

void water_request(struct water *water, double now) {
  if (water->fins_due) {
    water->fins_due = false;
    water->waiting = true;
    water->wait_until = now + water->timeout;
    water_send_fins(water, water->client, "fins");
  }
}

bool water_waiting(struct water *water, double now) {
  if (water->waiting && now >= water->wait_until) {
    water->waiting = false;
    water->late++;
  }
  return water->waiting;
}

// Count of the numbers in the text; -1 if there is anything else, or more than `most`.
static int read_numbers(const char *text, double *numbers, int most) {
  for (int count = 0;; count++) {
    char *end;
    double number = strtod(text, &end);
    if (end == text) {
      return text[strspn(text, " ")] ? -1 : count;
    }
    if (count == most) {
      return -1;
    }
    numbers[count] = number;
    text = end;
  }
}

bool water_sense(struct water *water, const char *text) {
  double n[SURROUNDINGS_NUMBERS] = {[FIN_LOAD] = 1};
  struct surroundings reading;
  int count = read_numbers(text, n, SURROUNDINGS_NUMBERS);
  if ((count != NUMBERS_WITHOUT_ENCODERS && count < FIN_LOAD) || !surroundings_read(&reading, n)) {
    return false;
  }
  board_set_surroundings(water->board, &reading);
  water->waiting = false;
  return true;
}
