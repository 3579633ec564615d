// The four fins: demands in, H-bridges and encoders out.
#pragma once
#include <stdint.h>

#include "fins/drive_watch.h"
#include "fins/fin_law.h"
#include "fins/position_loop.h"
#include "packets.gen.h"
#include "parameters.h"

namespace mucat {

enum class Motion : uint8_t {
  kOff,   // no drive, no motor power
  kSwim,  // flap as commanded
  kRest,  // stop flapping and rest where the fins point
  kDown,  // stop flapping and turn the tips down
};

class Fins {
 public:
  // Sets all drives to 0; they may still run from before the start. The calibration is used from now on, as
  // it is then.
  void start(const Calibration& calibration);
  // The newest command counts. It is mixed at the next tick, because mixing takes 1.5 ms. One that comes
  // before the motors have power is dropped.
  void command(const Navigation& command) {
    command_ = command;
    unmixed_ = true;
  }
  // One tick of 10 ms.
  void step(Motion motion, const Parameters& parameters);

  // No fin flaps, and none is commanded to flap.
  bool neutral() const;
  bool powered() const { return motion_ != Motion::kOff; }
  // Bits of DeviceFault: encoders with invalid readings, H-bridges that failed while powered, and fins that
  // did not follow their drives since the power came.
  uint16_t faults() const;
  // Writes set points, measured angles and drives into the packet; its time is that of the measurement.
  void report(Motor* packet) const;

 private:
  void read_encoders();
  void power(bool on);
  void read_bridge_faults();
  // Reads and clears a bridge's fault. True if it has one, and had none at the reading before.
  bool newly_tripped(uint8_t fin);
  int8_t find_drive(uint8_t fin, int16_t gain);
  void drive(uint8_t fin, int8_t drive);
  FinDemand demand(uint8_t fin) const;

  const Calibration* calibration_ = nullptr;
  Navigation command_ = {};
  bool unmixed_ = false;
  FinDemand demands_[kFinCount] = {};
  FinLaw laws_[kFinCount] = {};
  PositionLoop loops_[kFinCount] = {};
  DriveWatch watches_[kFinCount] = {};
  float set_points_[kFinCount] = {};
  float angles_[kFinCount] = {};
  int16_t counts_[kFinCount] = {};
  int16_t counts_before_[kFinCount] = {};
  uint32_t measured_us_ = 0;
  int8_t drives_[kFinCount] = {};
  uint8_t encoder_faults_ = 0;
  uint8_t yellow_fields_ = 0;
  uint8_t silent_bridges_ = 0;
  uint8_t reported_faults_ = 0;
  Motion motion_ = Motion::kOff;
  uint16_t phase_ = 0;
  uint8_t fault_read_tick_ = 0;
};

}  // namespace mucat
