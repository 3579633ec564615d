// What differs from robot to robot: one robot's fins.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

struct FinCalibration {
  int16_t zero;          // encoder counts where the fin lies along its mount
  int8_t rotation_sign;  // fin angle per shaft angle; the shaft grows under a positive drive
  int8_t encoder_sign;   // encoder counts per shaft angle
};

// Front right, back right, back left, front left.
constexpr FinCalibration kFinCalibration[kFinCount] = {
    {188, 1, -1},
    {161, 1, -1},
    {726, -1, -1},
    {356, -1, -1},
};

}  // namespace mucat
