// Written by `make generate` from robot_runtime/contract/packets/chip_parameters.py. Do not edit.
#pragma once
#include <stdint.h>

#include "board/flash.h"

namespace mucat {

enum ParameterNumber : uint8_t {
  kFinsFrequency,  // strokes of a flapping fin each second; Hz
  kFinsAmplitude,  // largest stroke, peak to peak, at full command; rad
  kFinsTurnRate,  // how fast the direction of a fin turns; rad/s
  kFinsGain,  // drive of a fin, in steps for each count of its error; a ratio
  kBatteryAlarm,  // below it for 20 s the robot is stopped; V
  kWaterDensity,  // 1 for fresh water, 1.025 for the sea; kg/L
};
constexpr uint8_t kParameterCount = 6;

// In thousandths of the unit.
struct ParameterLimits {
  uint16_t initial;
  uint16_t minimum;
  uint16_t maximum;
  bool while_armed;
};

const ParameterLimits kParameterLimits[kParameterCount] PROGMEM = {
    {1300, 300, 2000, true},
    {1600, 200, 1600, true},
    {4909, 2500, 4909, true},
    {625, 300, 1200, true},
    {6200, 6200, 7400, false},
    {1000, 990, 1050, false},
};

}  // namespace mucat
