// SPDX-License-Identifier: GPL-3.0-or-later
// The lockstep with the water: at every period of emulated time the board sends its fins and waits for the
// new inputs of its sensors.
#ifndef WATER_H
#define WATER_H

#include "board.h"
#include "clients.h"

struct water {
  struct board *board;
  struct clients *clients;
  struct client *client;  // NULL: no water, and the last values stay
  avr_cycle_count_t period;
  struct chip_timer due;
  bool fins_due;
  bool waiting;
  double wait_until;  // on the host's steady clock; infinity: no limit
  double timeout;     // s
  unsigned long late;
};

// `timeout`: s of real time to wait for an answer; infinity if time can wait.
void water_create(struct water *water, struct board *board, struct clients *clients, double timeout);

// Makes this client the water; the first period, in s, begins at this cycle. False if the period is out of
// range.
bool water_attach(struct water *water, struct client *client, double period, avr_cycle_count_t start);
void water_disconnect(struct water *water, const struct client *client);

// Sends a line of this word and the present fins.
void water_send_fins(struct water *water, struct client *client, const char *word);

// Call it when the chip was interrupted: sends the fins, and the board waits.
void water_request(struct water *water, double now);
bool water_waiting(struct water *water, double now);

// Sets the numbers of a `sense` line, with or without the encoders' errors and the load of the fins. False if
// they are not eleven, fifteen or sixteen possible numbers.
bool water_sense(struct water *water, const char *text);

#endif
