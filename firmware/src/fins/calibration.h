// Calibration of one robot's fins; it differs from robot to robot.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

struct FinCalibration {
  int16_t zero;          // encoder counts when the fin points along its mount
  int8_t rotation_sign;  // sign of fin angle per shaft angle; positive drive increases the shaft angle
  int8_t encoder_sign;   // sign of encoder counts per shaft angle
};

// Front right, back right, back left, front left.
constexpr FinCalibration kFinCalibration[kFinCount] = {
    {188, 1, -1},
    {161, 1, -1},
    {726, -1, -1},
    {356, -1, -1},
};

}  // namespace mucat
