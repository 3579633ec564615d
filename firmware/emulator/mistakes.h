// SPDX-License-Identifier: GPL-3.0-or-later
// The mistakes of wiring and the imperfections of parts that a board can have, by name.
#ifndef MISTAKES_H
#define MISTAKES_H

#include <stdbool.h>

#include "wiring.h"

// Their names with what follows the colon, a line each.
extern const char mistakes_usage[];

// Adds a mistake such as `imu-strap` or `leads-reversed:front-right`. False, without a change, for other
// words.
bool mistakes_add(struct wiring *wiring, const char *text);

#endif
