// Assembles the firmware of the robot's board: link, arming, fins and sensors.
#pragma once
#include <stdint.h>

#include "calibration.h"
#include "fins/fins.h"
#include "led.h"
#include "link/link.h"
#include "packets.gen.h"
#include "parameters.h"
#include "safety/arming.h"
#include "safety/leak.h"
#include "sensors/sensors.h"

namespace mucat {

class Robot {
 public:
  // At compile time, so that no constructor is in flash. All begins as zero, also in each part: then its
  // memory needs no values in flash either. What begins as something else is set by start().
  constexpr Robot() = default;
  void start();
  // One pass of the main loop: handles received messages, and one tick's work if a tick is due.
  void step();
  bool armed() const { return arming_.armed(); }
  // Sends a line of the sketch's own to the console; without room in the queue it is dropped and counted.
  void debug(DebugLine& line) { link_.queue_line(line); }

 private:
  void handle(const Message& message);
  void handle_calibration(const Message& message);
  void greet(const Hello& hello);
  void arm(const Start& start);
  void answer_requests();
  void tick(uint8_t ticks);
  void watch_battery(uint32_t now_ms);
  void watch_leak();
  Motion motion(uint32_t now_ms);
  void send_telemetry();
  void send_status();
  uint32_t faults() const;
  uint8_t flags() const;
  void report_boot();
  void report_disarmed(Disarming reason);
  void report_changed_faults();

  Link link_;
  Arming arming_;
  CalibrationStore calibration_;
  Fins fins_;
  Parameters parameters_;
  Sensors sensors_;
  BatteryAlarm battery_alarm_;
  LeakAlarm leak_alarm_;
  Led led_;
  uint32_t lowering_since_ms_ = 0;
  bool lowering_ = false;
  uint16_t epoch_ = 0;
  uint16_t loop_worst_ = 0;
  uint16_t missed_ticks_ = 0;
  uint8_t tick_of_second_ = 0;
  uint8_t slot_ = 0;
  uint8_t slot_tick_ = 0;
  uint32_t reported_faults_ = 0;
  bool reported_devices_ = false;
  bool reported_armed_ = false;
};

}  // namespace mucat
