// SPDX-License-Identifier: GPL-3.0-or-later
#include "line.h"

#include <math.h>

#define STOP_BIT_MIDDLE 9.5
#define SAMPLES_PER_BIT 8    // a receiver sees no gap that is shorter
#define CYCLE_FRACTION 1e-6  // rounding of cycles stored as doubles

static struct line_character *character(struct line *line, unsigned index) {
  return &line->characters[index % LINE_CHARACTERS_MAX];
}

static bool level_at(struct line *line, double time) {
  for (unsigned i = line->tail; i != line->head; i++) {
    const struct line_character *sent = character(line, i);
    double bits = (time - sent->start) / sent->bit;
    if (bits >= 0 && bits < CHARACTER_BITS) {
      return sent->levels >> (int)bits & 1;
    }
  }
  return true;
}

// The first falling edge from this time on; infinity if there is none.
static double falling_edge(struct line *line, double from) {
  bool before = true;
  double end = 0;
  for (unsigned i = line->tail; i != line->head; i++) {
    const struct line_character *sent = character(line, i);
    before = before || sent->start > end + sent->bit / SAMPLES_PER_BIT;  // between characters it is high
    for (int bit = 0; bit < CHARACTER_BITS; bit++) {
      bool level = sent->levels >> bit & 1;
      double time = sent->start + bit * sent->bit;
      if (before && !level && time >= from - CYCLE_FRACTION) {
        return time;
      }
      before = level;
    }
    end = sent->start + CHARACTER_BITS * sent->bit;
  }
  return INFINITY;
}

static void find_start_bit(struct line *line) {
  double edge = line->receiving ? INFINITY : falling_edge(line, line->receiver_free);
  if (isfinite(edge)) {
    line->receiving = true;
    line->edge = edge;
    double sampled = edge + STOP_BIT_MIDDLE * line->receiver_bit;
    chip_timer_start(&line->sampled, (avr_cycle_count_t)fmax(sampled, 0));
  }
}

// Drops ended characters except the last, which decides if the next one begins with an edge.
static void drop_past(struct line *line) {
  while (line->tail != line->head) {
    const struct line_character *oldest = character(line, line->tail);
    if (oldest->start + (CHARACTER_BITS + 1) * oldest->bit > line->receiver_free) {
      return;
    }
    line->tail++;
  }
}

static void on_sampled(void *owner) {
  struct line *line = owner;
  double bit = line->receiver_bit;
  bool false_start = level_at(line, line->edge + 0.5 * bit);
  bool framing_error = !level_at(line, line->edge + STOP_BIT_MIDDLE * bit);
  uint8_t byte = 0;
  for (int i = 0; i < 8; i++) {
    byte |= (uint8_t)(level_at(line, line->edge + (1.5 + i) * bit) << i);
  }
  line->receiving = false;
  line->receiver_free = line->edge + (false_start ? 0.5 : STOP_BIT_MIDDLE) * bit;
  drop_past(line);
  if (!false_start) {
    line->deliver(line->owner, byte, framing_error);
  }
  find_start_bit(line);
}

void line_create(struct line *line, struct chip *chip, double receiver_bit,
                 void (*deliver)(void *owner, uint8_t byte, bool framing_error), void *owner) {
  *line = (struct line){.chip = chip, .receiver_bit = receiver_bit, .deliver = deliver, .owner = owner};
  chip_timer_add(chip, &line->sampled, on_sampled, line);
}

// Occupies the line for one character with these levels.
static void put(struct line *line, double bit, unsigned levels) {
  if (line->head - line->tail < LINE_CHARACTERS_MAX) {
    *character(line, line->head++) =
        (struct line_character){.start = line->sender_free, .bit = bit, .levels = levels};
  }
  // One that the receiver misses, because it still samples a much slower one, takes its time, too.
  line->sender_free += CHARACTER_BITS * bit;
}

double line_send(struct line *line, uint8_t byte, double bit) {
  struct line_faults *faults = &line->faults;
  uint8_t other;
  double now = (double)chip_now(line->chip);
  line->sender_free = fmax(now, line->sender_free);
  if (!line->receiving) {
    line->receiver_free = now;
    drop_past(line);  // also drops characters that could not be received
  }
  if (line_faults_cut(faults)) {
    put(line, bit, LINE_IDLE_LEVELS);
    return line->sender_free;
  }
  if (line_faults_insert(faults, &other)) {
    put(line, bit, line_faults_levels(faults, other, line->sender_free, bit));
  }
  if (line_faults_drop(faults)) {
    put(line, bit, LINE_IDLE_LEVELS);
  } else {
    put(line, bit, line_faults_levels(faults, byte, line->sender_free, bit));
    if (line_faults_double(faults)) {
      put(line, bit, line_faults_levels(faults, byte, line->sender_free, bit));
    }
  }
  find_start_bit(line);
  return line->sender_free;
}

void line_cut(struct line *line) {
  double now = (double)chip_now(line->chip);
  while (line->head != line->tail && character(line, line->head - 1)->start >= now) {
    line->head--;
  }
  if (line->head != line->tail) {
    struct line_character *last = character(line, line->head - 1);
    int bits = (int)((now - last->start) / last->bit);
    last->levels |= bits < CHARACTER_BITS ? LINE_IDLE_LEVELS << (bits + 1) : 0;
  }
  line->sender_free = now;
}

void line_clear(struct line *line) {
  chip_timer_stop(&line->sampled);
  line->receiving = false;
  line->head = line->tail;
  line->sender_free = line->receiver_free = (double)chip_now(line->chip);
}
