// What differs from robot to robot, in EEPROM.
#pragma once
#include <stdint.h>

#include "board/flash.h"
#include "packets.gen.h"

namespace mucat {

// The step of the lowest bit that is set.
FlashText describe_step(uint8_t steps);

class CalibrationStore {
 public:
  // Reads the record. Without a valid record no step is done. In the loop there is nothing to calibrate.
  void start();
  const Calibration& value() const { return record_.calibration; }
  // The bits of CalibrationStep that are not done; all while a calibration is being written.
  uint8_t missing() const;

  // Puts it into force and begins to write it, unless it is impossible. Either way an answer is due.
  void store(const Calibration& calibration);
  void request() { answer_due_ = true; }
  // One tick: writes a byte. After the last one it reads all of them again: the answer says what EEPROM
  // holds.
  void step();
  bool answer_due() const { return answer_due_ && !writing(); }
  void answered() { answer_due_ = false; }

 private:
  struct __attribute__((packed)) Record {
    uint8_t version;
    Calibration calibration;
    uint32_t checksum;  // CRC-32 of all before
  };
  static constexpr uint8_t kIdle = 0xFF;

  bool writing() const { return next_byte_ != kIdle; }
  uint32_t checksum() const;

  Record record_;
  uint8_t next_byte_ = kIdle;
  bool answer_due_ = false;
};

}  // namespace mucat
