// The chip's counts of received data.
#pragma once

#include <stdint.h>

#include "parameters.h"

// Two bytes each; no test sends enough to overflow one.
struct Counts {
  uint16_t right = 0;
  uint16_t out_of_sequence = 0;
  uint16_t checksum_errors = 0;
  uint16_t framing_errors = 0;
  uint16_t ring_full = 0;
  uint16_t bytes_read = 0;

  // Counts a number: right if it belongs to the test and is greater than all right ones before it.
  void count(uint16_t number) {
    if (number >= next_ && number < COMM_TEST_TO) {
      right++;
      next_ = number + 1;
    } else {
      out_of_sequence++;
    }
  }

 private:
  uint16_t next_ = COMM_TEST_FROM;
};

// Result of reading a byte or frame.
enum Event : uint8_t { NOTHING, MESSAGE, REQUEST };
