// Which telemetry goes out in which tick, and how much of it the line carries.
//
// In ten slots: Imu in all, Motor in the even, Depth in the odd, Beacon and Status in one each. Imu with
// Motor, or Imu with Depth and Beacon, fill one frame; Status goes in a second one. At full rate that is 5.5
// kB/s. A slot is one tick where the line carries that with a quarter to spare, and as many ticks as it takes
// where it does not.
#pragma once
#include <stdint.h>

#include "link/baud.h"
#include "link/frame.h"
#include "packets.gen.h"

namespace mucat {

constexpr uint8_t kSlots = 10;
constexpr uint8_t kBeaconSlot = 5;
constexpr uint8_t kStatusSlot = 3;

constexpr bool has_motor(uint8_t slot) { return slot % 2 == 0; }
constexpr bool has_depth(uint8_t slot) { return slot % 2 == 1; }

constexpr uint16_t kFrameOverhead = kFrameBytesMax - kMessagesBytesMax;
constexpr uint16_t kBytesPerTenSlots = 10 * (1 + sizeof(Imu)) + 5 * (1 + sizeof(Motor)) +
                                       5 * (1 + sizeof(Depth)) + (1 + sizeof(Beacon)) + (1 + sizeof(Status)) +
                                       11 * kFrameOverhead;
static_assert(2 + sizeof(Imu) + sizeof(Motor) <= kMessagesBytesMax, "Imu and Motor need a frame each");
static_assert(3 + sizeof(Imu) + sizeof(Depth) + sizeof(Beacon) <= kMessagesBytesMax,
              "Beacon needs another frame");

// Ten slots a tenth of a second, ten bits a byte, a quarter to spare.
constexpr uint32_t kBitsPerSecond = kBytesPerTenSlots * 10UL * 10 * 5 / 4;
constexpr uint8_t kTicksPerSlot = (kBitsPerSecond + kBaud - 1) / kBaud;

}  // namespace mucat
