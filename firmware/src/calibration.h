// What differs from robot to robot, in EEPROM.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

// The step of the lowest bit that is set.
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
  bool answer_due() const { return answer_due_ && !writing_; }
  void answered() { answer_due_ = false; }

 private:
  struct __attribute__((packed)) Record {
    uint8_t version;
    Calibration calibration;
    uint32_t checksum;  // CRC-32 of all before
  };

  uint32_t checksum() const;

  Record record_ = {};
  bool writing_ = false;
  uint8_t next_byte_ = 0;  // to be written
  bool answer_due_ = false;
};

}  // namespace mucat
