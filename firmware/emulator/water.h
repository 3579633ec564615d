// SPDX-License-Identifier: GPL-3.0-or-later
// The lockstep with the water: at every period of emulated time the board tells of its fins and waits for
// the new inputs of its sensors.
#ifndef WATER_H
#define WATER_H

#include "board.h"
#include "clients.h"

struct water {
  struct board *board;
  struct clients *clients;
  struct client *client;  // NULL: nobody, and the last values hold
  avr_cycle_count_t period;
  struct chip_timer due;
  bool fins_due;
  bool waiting;
  double waiting_until;  // on the host's steady clock; infinity: as long as it takes
  double patience;       // s
  unsigned long late;
};

// `patience`: s of real time to wait for an answer; infinity where time can wait.
void water_create(struct water *water, struct board *board, struct clients *clients, double patience);

// The first period, in s, begins at this cycle. False where no board can keep such a period.
bool water_attach(struct water *water, struct client *client, double period, avr_cycle_count_t start);
void water_gone(struct water *water, const struct client *client);

// Sends a line of this word and the fins as they are now.
void water_tell_fins(struct water *water, struct client *client, const char *word);

// To be called when the chip was interrupted: the fins are told, and the board waits.
void water_ask(struct water *water, double now);
bool water_awaited(struct water *water, double now);

// Takes in the numbers of a `sense` line, with or without the encoders' errors. False where they are not
// eleven or fifteen numbers that can be.
bool water_sense(struct water *water, const char *text);

#endif
