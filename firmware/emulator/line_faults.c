// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_faults.h"

#include <stdio.h>
#include <string.h>

#define BURST_BITS_MAX 1e6

// SplitMix64, by Sebastiano Vigna.
static uint64_t random_word(struct line_faults *faults) {
  uint64_t word = faults->generator += 0x9e3779b97f4a7c15;
  word = (word ^ word >> 30) * 0xbf58476d1ce4e5b9;
  word = (word ^ word >> 27) * 0x94d049bb133111eb;
  return word ^ word >> 31;
}

static bool draw(struct line_faults *faults, double rate) {
  return rate > 0 && (double)(random_word(faults) >> 11) * 0x1p-53 < rate;
}

static bool draw_and_count(struct line_faults *faults, double rate, unsigned long *count) {
  bool does = draw(faults, rate);
  *count += does;
  return does;
}

void line_faults_seed(struct line_faults *faults, uint64_t seed) {
  faults->generator = seed;
  faults->burst_end = 0;
}

static void clean(struct line_faults *faults) {
  *faults = (struct line_faults){.generator = faults->generator, .counts = faults->counts};
}

static bool set_rate(double *rate, const char *value) {
  double number;
  char rest;
  bool valid = sscanf(value, "%lf%c", &number, &rest) == 1 && number >= 0 && number <= 1;
  if (valid) {
    *rate = number;
  }
  return valid;
}

static bool set_bursts(struct line_faults *faults, const char *value) {
  double rate, bits;
  char rest;
  bool valid = sscanf(value, "%lf %lf%c", &rate, &bits, &rest) == 2 && rate >= 0 && rate <= 1 && bits >= 1 &&
               bits <= BURST_BITS_MAX;
  if (valid) {
    faults->bursts = rate;
    faults->burst_bits = bits;
  }
  return valid;
}

bool line_faults_set(struct line_faults *faults, const char *kind, const char *value) {
  const struct {
    const char *kind;
    double *rate;
  } rates[] = {{"bit_errors", &faults->bit_errors},
               {"drop", &faults->drops},
               {"double", &faults->doubles},
               {"insert", &faults->inserts}};
  for (unsigned i = 0; i < sizeof rates / sizeof *rates; i++) {
    if (!strcmp(kind, rates[i].kind)) {
      return set_rate(rates[i].rate, value);
    }
  }
  if (!strcmp(kind, "burst")) {
    return set_bursts(faults, value);
  }
  if (!strcmp(kind, "cut") && (!strcmp(value, "on") || !strcmp(value, "off"))) {
    faults->cut = !strcmp(value, "on");
    return true;
  }
  if (!strcmp(kind, "clean") && !*value) {
    clean(faults);
    return true;
  }
  return false;
}

bool line_faults_cut(struct line_faults *faults) {
  faults->counts.cuts += faults->cut;
  return faults->cut;
}

bool line_faults_drop(struct line_faults *faults) {
  return draw_and_count(faults, faults->drops, &faults->counts.drops);
}

bool line_faults_double(struct line_faults *faults) {
  return draw_and_count(faults, faults->doubles, &faults->counts.doubles);
}

bool line_faults_insert(struct line_faults *faults, uint8_t *byte) {
  bool does = draw_and_count(faults, faults->inserts, &faults->counts.inserts);
  if (does) {
    *byte = (uint8_t)(random_word(faults) >> 56);
  }
  return does;
}

unsigned line_faults_levels(struct line_faults *faults, uint8_t byte, double start, double bit) {
  unsigned levels = (unsigned)byte << 1 | 1u << (CHARACTER_BITS - 1);
  for (unsigned i = 0; i < CHARACTER_BITS; i++) {
    double time = start + i * bit;
    if (time >= faults->burst_end && draw_and_count(faults, faults->bursts, &faults->counts.bursts)) {
      faults->burst_end = time + faults->burst_bits * bit;
    }
    bool wrong = time < faults->burst_end
                     ? draw_and_count(faults, 0.5, &faults->counts.burst_errors)
                     : draw_and_count(faults, faults->bit_errors, &faults->counts.bit_errors);
    levels ^= (unsigned)wrong << i;
  }
  return levels;
}
