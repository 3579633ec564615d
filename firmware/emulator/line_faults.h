// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of characters on one direction of the serial line, at chosen rates. The same seed and the same
// characters at the same times give the same faults.
#ifndef LINE_FAULTS_H
#define LINE_FAULTS_H

#include <stdbool.h>
#include <stdint.h>

#define CHARACTER_BITS 10       // start bit, eight of data, stop bit
#define LINE_IDLE_LEVELS 0x3ff  // the levels of an idle line for one character

struct line_fault_counts {
  unsigned long bit_errors;
  unsigned long drops, doubles, inserts;  // characters
  unsigned long bursts;
  unsigned long burst_errors;  // bits inverted in bursts
  unsigned long cuts;          // characters lost because the line was cut
};

struct line_faults {
  uint64_t generator;
  double bit_errors;               // probability of each bit on the wire
  double drops, doubles, inserts;  // probability of each character
  double bursts;                   // probability that a burst begins, of each bit on the wire
  double burst_bits;               // bit times that a burst lasts; half of the bits in it are wrong
  double burst_end;                // cycle
  bool cut;
  struct line_fault_counts counts;
};

// Sets the seed of the faults.
void line_faults_seed(struct line_faults *faults, uint64_t seed);

// Sets a rate, a burst's rate and length, `cut on` or `cut off`, or `clean`; false for anything else.
bool line_faults_set(struct line_faults *faults, const char *kind, const char *value);

// True if this fault hits the next character; counts it then.
bool line_faults_cut(struct line_faults *faults);
bool line_faults_drop(struct line_faults *faults);
bool line_faults_double(struct line_faults *faults);
bool line_faults_insert(struct line_faults *faults, uint8_t *byte);

// The levels of a character's ten bits, the start bit being bit 0, after the faults from this cycle
// on.
unsigned line_faults_levels(struct line_faults *faults, uint8_t byte, double start, double bit);

#endif
