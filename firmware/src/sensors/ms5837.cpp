#include "sensors/ms5837.h"

#include "board/board.h"

namespace mucat {
namespace {

constexpr uint8_t kAddress = 0x76;
constexpr uint8_t kReset = 0x1E;
constexpr uint8_t kReadProm = 0xA0;
constexpr uint8_t kReadConversion = 0x00;
// 2048 samples take 4.6 ms, which fits into a tick wherever in it the conversion starts; 4096 would take 9.1
// ms. The resolution is 4 mm of water.
constexpr uint8_t kConvertPressure = 0x46;
constexpr uint8_t kConvertTemperature = 0x56;

constexpr uint8_t kRetry = 10;

// A product of 64 bits takes 200 bytes of the chip's program wherever it is written out. A shift, not a
// division: the data sheet's example rounds downwards, and a shift is quicker.
__attribute__((noinline)) int64_t product(int32_t one, int32_t other, uint8_t shift) {
  return static_cast<int64_t>(one) * other >> shift;
}

bool command(uint8_t byte) { return board::exchange_i2c(kAddress, &byte, 1, nullptr, 0); }

}  // namespace

// The four-bit CRC of AN520 (TE Connectivity), polynomial x^4 + x + 1, in the upper four bits of the first
// word.
bool prom_valid(const uint16_t (&prom)[kPromWords]) {
  uint16_t remainder = 0;
  for (uint8_t byte = 0; byte < 16; ++byte) {
    uint16_t word = byte / 2 < kPromWords ? prom[byte / 2] : 0;
    if (byte < 2) word &= 0x0FFF;
    remainder ^= byte % 2 ? word & 0xFF : word >> 8;
    for (uint8_t bit = 0; bit < 8; ++bit)
      remainder = remainder & 0x8000 ? remainder << 1 ^ 0x3000 : remainder << 1;
  }
  return remainder >> 12 == prom[0] >> 12;
}

PressureReading compensate(const uint16_t (&prom)[kPromWords], uint32_t d1, uint32_t d2) {
  const int32_t from_reference = static_cast<int32_t>(d2) - (static_cast<int32_t>(prom[5]) << 8);
  int32_t temperature = 2000 + static_cast<int32_t>(product(from_reference, prom[6], 23));
  int64_t offset = product(prom[2], 1L << 16, 0) + product(from_reference, prom[4], 7);
  int64_t sensitivity = product(prom[1], 1L << 15, 0) + product(from_reference, prom[3], 8);

  const int32_t from_20 = temperature - 2000;
  if (from_20 < 0) {
    offset -= product(3 * from_20, from_20, 1);
    sensitivity -= product(5 * from_20, from_20, 3);
    if (temperature < -1500) {
      const int32_t from_15_below = temperature + 1500;
      offset -= product(7 * from_15_below, from_15_below, 0);
      sensitivity -= product(4 * from_15_below, from_15_below, 0);
    }
    temperature -= static_cast<int32_t>(product(3 * from_reference, from_reference, 33));
  } else {
    offset -= product(from_20, from_20, 4);
    temperature -= static_cast<int32_t>(product(2 * from_reference, from_reference, 37));
  }
  // The data sheet's unit is 0.1 mbar; ten times that is Pa.
  const int64_t counts = (static_cast<int64_t>(d1) * sensitivity >> 21) - offset;
  return {static_cast<int32_t>(counts * 10 >> 13), static_cast<int16_t>(temperature)};
}

// Not inlined: the registers that it takes cost the main loop 1,100 bytes.
__attribute__((noinline)) bool Ms5837::step(PressureReading* reading) {
  if (wait_) {
    --wait_;
    return false;
  }
  bool fresh = false;
  if (advance(reading, &fresh)) {
    retried_ = false;
  } else if (!retried_) {
    retried_ = true;  // once more in the next tick, since starting over takes 140 ms
  } else {
    retried_ = taken_ = false;
    faulty_ = true;
    stage_ = Stage::kReset;
    wait_ = kRetry;
  }
  return fresh;
}

// Where a conversion was taken and the next one could not be started, only that is tried again.
bool Ms5837::advance(PressureReading* reading, bool* fresh) {
  switch (stage_) {
    case Stage::kReset:
      if (!command(kReset)) return false;
      stage_ = Stage::kProm;
      return true;
    case Stage::kProm:
      if (!read_prom() || !command(kConvertTemperature)) return false;
      stage_ = Stage::kTemperature;
      return true;
    case Stage::kTemperature:
      if (!taken_) taken_ = take_conversion(&temperature_counts_);
      if (!taken_ || !command(kConvertPressure)) return false;
      stage_ = Stage::kPressure;
      taken_ = false;
      return true;
    case Stage::kPressure:
      uint32_t counts;
      if (!taken_ && take_conversion(&counts)) {
        *reading = compensate(prom_, counts, temperature_counts_);
        *fresh = taken_ = true;
        faulty_ = false;
      }
      if (!taken_ || !command(kConvertTemperature)) return false;
      stage_ = Stage::kTemperature;
      taken_ = false;
      return true;
  }
  return false;
}

bool Ms5837::read_prom() {
  for (uint8_t i = 0; i < kPromWords; ++i) {
    uint8_t bytes[2];
    if (!command(kReadProm + 2 * i) || !board::exchange_i2c(kAddress, nullptr, 0, bytes, sizeof bytes))
      return false;
    prom_[i] = static_cast<uint16_t>(bytes[0]) << 8 | bytes[1];
  }
  return prom_valid(prom_);
}

bool Ms5837::take_conversion(uint32_t* counts) {
  uint8_t bytes[3];
  if (!command(kReadConversion) || !board::exchange_i2c(kAddress, nullptr, 0, bytes, sizeof bytes))
    return false;
  *counts = static_cast<uint32_t>(bytes[0]) << 16 | static_cast<uint16_t>(bytes[1]) << 8 | bytes[2];
  // The chip answers 0 if no conversion was ready.
  return *counts != 0;
}

}  // namespace mucat
