// The damaging line with plain C names, for Python.
#include <string.h>

#include "corruption.h"

using mucat::host::Corruption;
using mucat::host::Counts;
using mucat::host::Damage;

extern "C" {

Corruption* corruption_create(uint8_t damage, double rate, uint64_t seed) {
  return new Corruption(static_cast<Damage>(damage), rate, seed);
}
void corruption_destroy(Corruption* corruption) { delete corruption; }
uint32_t corruption_key(const Corruption* corruption) { return corruption->key(); }
void corruption_carry(Corruption* corruption, uint32_t frames) { corruption->carry(frames); }

// Writes corrupted, accepted and undetected frames, by the chip's decoder.
void corruption_read(const Corruption* corruption, uint32_t* counts) {
  const Counts read = corruption->read();
  counts[0] = read.corrupted;
  counts[1] = read.accepted;
  counts[2] = read.undetected;
}

const uint8_t* corruption_line(const Corruption* corruption) { return corruption->line().data(); }
uint32_t corruption_line_size(const Corruption* corruption) {
  return static_cast<uint32_t>(corruption->line().size());
}
const uint8_t* corruption_sent(const Corruption* corruption) { return corruption->sent().data(); }
uint32_t corruption_sent_size(const Corruption* corruption) {
  return static_cast<uint32_t>(corruption->sent().size());
}
const uint8_t* corruption_damaged(const Corruption* corruption) { return corruption->damaged().data(); }
uint32_t corruption_damaged_size(const Corruption* corruption) {
  return static_cast<uint32_t>(corruption->damaged().size());
}
uint32_t corruption_foreign(const Corruption* corruption) { return corruption->foreign(); }
}
