#include "sensors/as5040.h"

#include "board/board.h"

namespace mucat {
namespace {

// The status bits of the word.
constexpr uint16_t kOffsetDone = 1 << 5;
constexpr uint16_t kCordicOverflow = 1 << 4;
constexpr uint16_t kLinearityAlarm = 1 << 3;
constexpr uint16_t kBothMagBits = 3 << 1;

bool odd(uint16_t word) {
  word ^= word >> 8;
  word ^= word >> 4;
  word ^= word >> 2;
  word ^= word >> 1;
  return word & 1;
}

}  // namespace

uint16_t read_encoder_word(uint8_t fin) {
  uint8_t bytes[board::kEncoderBytes];
  board::read_encoder(fin, bytes);
  return static_cast<uint16_t>(bytes[0]) << 9 | static_cast<uint16_t>(bytes[1]) << 1 | bytes[2] >> 7;
}

MagneticField read_encoder_counts(uint8_t fin, int16_t* counts) {
  const uint16_t word = read_encoder_word(fin);
  if (odd(word) || !(word & kOffsetDone) || word & kCordicOverflow) return MagneticField::kUnusable;
  const bool far_off = (word & kBothMagBits) == kBothMagBits;
  // With the alarm the data sheet calls the field red, without it yellow: usable, less exact.
  if (far_off && word & kLinearityAlarm) return MagneticField::kUnusable;
  *counts = word >> 6;
  return far_off ? MagneticField::kYellow : MagneticField::kGreen;
}

}  // namespace mucat
