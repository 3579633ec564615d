// The tunable parameters. A reset clears them: the host sends them again after each greeting.
#pragma once
#include <stdint.h>

#include "packets.gen.h"
#include "parameters.gen.h"

namespace mucat {

class Parameters {
 public:
  // Sets all to their initial values.
  void start();
  // In thousandths of its unit.
  uint16_t operator[](ParameterNumber number) const { return values_[number]; }
  float value(ParameterNumber number) const { return values_[number] * 0.001f; }
  // Sets the value if it is within its limits, and may change while armed if the board is armed. Either way
  // an answer is due.
  void request(const Parameter& requested, bool armed);

  // The next answer that is due; false if there is none. It stays the next until answered().
  bool next(Parameter* answer) const;
  void answered(uint8_t number) { unanswered_ &= ~(1 << number); }

 private:
  uint16_t values_[kParameterCount] = {};
  uint8_t unanswered_ = 0;
};

}  // namespace mucat
