// A fin's position loop: encoder counts in, H-bridge command out, the shortest way round.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

constexpr int16_t kCountsPerTurn = 1024;
constexpr int8_t kDriveMax = 40;

// Gain of one drive step for each count of error.
constexpr int16_t kGainUnit = 256;
inline int16_t gain_from_thousandths(uint16_t gain) { return gain * 32 / 125; }

// A fin's part of the calibration.
struct FinCalibration {
  int16_t zero;       // encoder counts when the fin points along its mount
  int8_t angle_sign;  // of the fin's angle per count
  int8_t drive_sign;  // of counts per drive
};
FinCalibration fin_calibration(const Calibration& calibration, uint8_t fin);

// The same position within -512 to 511.
int16_t wrap_counts(int16_t counts);
// The encoder's counts at a fin angle (rad).
int16_t counts_from_angle(const FinCalibration& fin, float angle);
// The fin angle at these counts, within -π to π.
float angle_from_counts(const FinCalibration& fin, int16_t counts);
// Controls the angle of one fin.
class PositionLoop {
 public:
  // Resets the loop. Call it if the loop was not stepped for a while.
  void restart() { stepped_ = false; }
  // One tick: the H-bridge command, within ±kDriveMax, for these counts. `gain` is in units of kGainUnit.
  int8_t step(const FinCalibration& fin, int16_t set_point, int16_t measured, int16_t gain);

 private:
  int16_t last_error_ = 0;
  bool stepped_ = false;  // since it was restarted
};

}  // namespace mucat
