// MS5837-30BA pressure sensor on I2C (data sheet rev. C2, 12/2019).
#pragma once
#include <stdint.h>

namespace mucat {

struct PressureReading {
  int32_t pressure;     // Pa, absolute
  int16_t temperature;  // 0.01 °C
};

constexpr uint8_t kPromWords = 7;
// A conversion takes 4.54 ms, and is spoiled if it is read before. A step takes up to 3 ms until it starts
// one.
constexpr uint16_t kPressureStepUs = 7600;

// True if the PROM's checksum is right.
bool prom_valid(const uint16_t (&prom)[kPromWords]);
// Pressure and temperature from the PROM and the two conversions, with second-order compensation.
PressureReading compensate(const uint16_t (&prom)[kPromWords], uint32_t d1, uint32_t d2);

// Steps through reset, PROM and conversions, one each tick; never waits for one.
class Ms5837 {
 public:
  // Call every tick of 10 ms, but not sooner after the last one than kPressureStepUs. True, every other tick,
  // if `reading` is new.
  bool step(PressureReading* reading);
  bool faulty() const { return faulty_; }

 private:
  enum class Stage : uint8_t { kReset, kProm, kTemperature, kPressure };

  bool advance(PressureReading* reading, bool* fresh);
  bool read_prom();
  bool take_conversion(uint32_t* counts);

  uint16_t prom_[kPromWords] = {};
  uint32_t temperature_counts_ = 0;
  Stage stage_ = Stage::kReset;
  uint8_t wait_ = 0;
  bool faulty_ = false;
  bool retried_ = false;  // the last step failed, and is taken again
  bool taken_ = false;    // of this stage, the conversion
};

}  // namespace mucat
