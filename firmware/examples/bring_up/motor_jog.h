// One motor at a low drive, for as long as the host asks for it again and again.
#pragma once

#include <mucat.h>

#include "board/board.h"
#include "fins/drv8830.h"

class MotorJog {
 public:
  // Turns this motor from now on, for kHoldMs; any other one stops.
  void drive(const mucat::Jog &jog) {
    if (jog.fin >= mucat::kFinCount) return;
    const int8_t drive = jog.drive > kDriveMax ? kDriveMax : jog.drive < -kDriveMax ? -kDriveMax : jog.drive;
    if (drive == 0) {
      stop();
      return;
    }
    if (drive_ != 0 && fin_ != jog.fin) mucat::drive_bridge(fin_, 0);
    fin_ = jog.fin;
    drive_ = drive;
    asked_ms_ = mucat::board::milliseconds();
  }

  void stop() {
    if (drive_ != 0) mucat::drive_bridge(fin_, 0);
    drive_ = 0;
    mucat::board::set_motor_power(false);
  }

  // One tick. The motors have power while one turns, or while `needed`.
  void step(bool needed) {
    if (drive_ != 0 && mucat::board::milliseconds() - asked_ms_ >= kHoldMs) stop();
    mucat::board::set_motor_power(needed || drive_ != 0);
    mucat::board::set_led(drive_ != 0);
    // Again and again: an H-bridge answers some milliseconds after its power.
    if (drive_ != 0) mucat::drive_bridge(fin_, drive_);
  }

 private:
  static constexpr int8_t kDriveMax = 20;
  static constexpr uint32_t kHoldMs = 250;

  uint32_t asked_ms_ = 0;
  uint8_t fin_ = 0;
  int8_t drive_ = 0;
};
