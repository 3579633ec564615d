// The baud rate of the serial line. Set -DMUCAT_BAUD=... for another one.
#pragma once
#include <stdint.h>

#ifndef MUCAT_BAUD
#define MUCAT_BAUD 250000
#endif

namespace mucat {

constexpr uint32_t kBaud = MUCAT_BAUD;
static_assert(kBaud >= 1200 && kBaud <= 500000,
              "baud outside 1200 to 500000: above, interrupts fill the chip");

}  // namespace mucat
