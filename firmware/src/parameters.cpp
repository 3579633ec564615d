#include "parameters.h"

namespace mucat {
namespace {

static_assert(kParameterCount <= 8, "more parameters than bits of unanswered_");

uint16_t read(const uint16_t& in_flash) { return pgm_read_word(&in_flash); }

}  // namespace

void Parameters::start() {
  for (uint8_t i = 0; i < kParameterCount; ++i) values_[i] = read(kParameterLimits[i].initial);
}

void Parameters::request(const Parameter& requested, bool armed) {
  if (requested.number >= kParameterCount) return;
  const ParameterLimits& limits = kParameterLimits[requested.number];
  const bool in_range = requested.value >= read(limits.minimum) && requested.value <= read(limits.maximum);
  const bool now = !armed || pgm_read_byte(&limits.while_armed);
  if (in_range && now) values_[requested.number] = requested.value;
  unanswered_ |= 1 << requested.number;
}

bool Parameters::next(Parameter* answer) const {
  for (uint8_t i = 0; i < kParameterCount; ++i) {
    if (!(unanswered_ >> i & 1)) continue;
    *answer = Parameter{i, values_[i]};
    return true;
  }
  return false;
}

}  // namespace mucat
