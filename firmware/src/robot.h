// The robot's board: the one place where all of it is put together.
#pragma once
#include <stdint.h>

#include "fins/fins.h"
#include "link/link.h"
#include "packets.gen.h"
#include "parameters.h"
#include "safety/arming.h"
#include "sensors/sensors.h"

namespace mucat {

class Robot {
 public:
  void start();
  // One pass of the main loop. Takes what came on the line, and does one tick's work where a tick is due.
  void step();
  bool armed() const { return arming_.armed(); }

 private:
  void handle(const Message& message);
  void greet(const Hello& hello);
  void arm(const Start& start);
  void answer_parameters();
  void tick(uint8_t ticks);
  void watch_battery(uint32_t now_ms);
  Motion motion(uint32_t now_ms);
  void send_telemetry();
  void send_status();
  uint8_t faults() const { return sensors_.faults() | fins_.faults(); }
  uint8_t flags() const;
  void say_boot();
  void say_disarmed(Disarming reason);
  void say_changed_faults();

  Link link_;
  Arming arming_;
  Fins fins_;
  Parameters parameters_;
  Sensors sensors_;
  BatteryAlarm battery_alarm_;
  uint32_t lowering_since_ms_ = 0;
  bool lowering_ = false;
  uint16_t epoch_ = 0;
  uint16_t loop_worst_ = 0;
  uint16_t missed_ticks_ = 0;
  uint8_t tick_of_second_ = 0;
  uint8_t slot_ = 0;
  uint8_t slot_tick_ = 0;
  uint8_t said_faults_ = 0;
  bool said_devices_ = false;
  bool said_armed_ = false;
};

}  // namespace mucat
