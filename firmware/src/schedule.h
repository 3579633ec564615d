// The schedule of telemetry: the ticks in which each packet is sent.
//
// Ten slots: Imu in all, Motor in the even, Depth in the odd, Beacon and Status in one each. Imu with Motor,
// or Imu with Depth and Beacon, fill one frame; Status goes in a second one. At full rate that is 5.5 kB/s. A
// slot is one tick if the line carries that with a quarter to spare; otherwise it is longer.
//
// If a slot would be longer than four ticks, there are three slots instead: Depth, the input of control, in
// all of them, with Imu, then Motor, then Beacon and Status. robot_runtime/link/timing.py has the same
// schedules.
#pragma once
#include <stdint.h>

#include "link/baud.h"
#include "link/frame.h"
#include "packets.gen.h"

namespace mucat {

constexpr uint16_t kBytesPerTenSlots = 10 * (1 + sizeof(Imu)) + 5 * (1 + sizeof(Motor)) +
                                       5 * (1 + sizeof(Depth)) + (1 + sizeof(Beacon)) + (1 + sizeof(Status)) +
                                       11 * kFrameOverhead;
constexpr uint16_t kBytesPerThreeSlots = (1 + sizeof(Imu)) + (1 + sizeof(Motor)) + 3 * (1 + sizeof(Depth)) +
                                         (1 + sizeof(Beacon)) + (1 + sizeof(Status)) + 3 * kFrameOverhead;
static_assert(2 + sizeof(Imu) + sizeof(Motor) <= kMessagesBytesMax, "Imu and Motor need a frame each");
static_assert(3 + sizeof(Imu) + sizeof(Depth) + sizeof(Beacon) <= kMessagesBytesMax,
              "Beacon needs another frame");
static_assert(3 + sizeof(Depth) + sizeof(Beacon) + sizeof(Status) <= kMessagesBytesMax,
              "Status needs a frame of its own on a slow line");

// A hundred ticks a second, ten bits a byte, a quarter to spare.
constexpr uint8_t ticks_per_slot(uint16_t bytes, uint8_t slots) {
  return (bytes * 10UL * 100 * 5 / 4 / slots + kBaud - 1) / kBaud;
}
constexpr uint8_t kTicksPerSlotMax = 4;
constexpr bool kSlow = ticks_per_slot(kBytesPerTenSlots, 10) > kTicksPerSlotMax;
constexpr uint8_t kSlots = kSlow ? 3 : 10;
constexpr uint8_t kTicksPerSlot =
    kSlow ? ticks_per_slot(kBytesPerThreeSlots, 3) : ticks_per_slot(kBytesPerTenSlots, 10);

constexpr uint8_t kBeaconSlot = kSlow ? 2 : 5;
constexpr uint8_t kStatusSlot = kSlow ? 2 : 3;
constexpr bool has_imu(uint8_t slot) { return !kSlow || slot == 0; }
constexpr bool has_motor(uint8_t slot) { return kSlow ? slot == 1 : slot % 2 == 0; }
constexpr bool has_depth(uint8_t slot) { return kSlow || slot % 2 == 1; }

}  // namespace mucat
