#include "fins/fins.h"

#include <math.h>

#include "board/board.h"
#include "fins/drv8830.h"
#include "sensors/as5040.h"

namespace mucat {
namespace {

constexpr float kTipsDown = 1.57f;
constexpr uint8_t kTicksPerFaultRead = 10;

void assign(uint8_t* bits, uint8_t index, bool on) {
  const uint8_t bit = 1 << index;
  *bits = on ? *bits | bit : *bits & ~bit;
}

}  // namespace

void Fins::start(const Calibration& calibration) {
  calibration_ = &calibration;
  // An H-bridge keeps its command when this chip resets. It may not answer now: motor power feeds it.
  for (uint8_t i = 0; i < kFinCount; ++i) drive_bridge(i, 0);
}

// Not inlined: its two callers would have a copy each, of 900 bytes.
__attribute__((noinline)) void Fins::step(Motion motion, const Parameters& parameters) {
  read_encoders();
  const bool was_powered = powered();
  if (motion == Motion::kOff) {
    if (was_powered) power(false);
    for (uint8_t i = 0; i < kFinCount; ++i) set_points_[i] = angles_[i];
    motion_ = motion;
    return;
  }
  motion_ = motion;
  if (!was_powered) {
    power(true);
    return;  // an H-bridge needs some milliseconds of power before it answers
  }
  if (unmixed_) mix(command_, parameters.value(kFinsAmplitude), demands_);
  unmixed_ = false;
  phase_ += phase_per_tick(parameters.value(kFinsFrequency));
  const float turn = parameters.value(kFinsTurnRate) * kTickSeconds;
  const int16_t gain = gain_from_thousandths(parameters[kFinsGain]);
  for (uint8_t i = 0; i < kFinCount; ++i) {
    set_points_[i] = laws_[i].step(demand(i), phase_ + fin_phase(i), turn);
    drive(i, find_drive(i, gain));
  }
  read_bridge_faults();
}

int8_t Fins::find_drive(uint8_t fin, int16_t gain) {
  const FinCalibration calibration = fin_calibration(*calibration_, fin);
  DriveWatch& watch = watches_[fin];
  const uint8_t bit = 1 << fin;
  // While its encoder or its H-bridge fails, what a fin does says nothing about its motor.
  if (!((encoder_faults_ | silent_bridges_) & bit) && !watch.failed()) {
    watch.step(drives_[fin], calibration.drive_sign * wrap_counts(counts_[fin] - counts_before_[fin]));
    // The bridge may have tripped since its last reading.
    if (watch.failed() && newly_tripped(fin)) watch.restart();
  }
  if (encoder_faults_ & bit || watch.failed()) {
    loops_[fin].restart();
    return 0;
  }
  return loops_[fin].step(calibration, counts_from_angle(calibration, set_points_[fin]), counts_[fin], gain);
}

FinDemand Fins::demand(uint8_t fin) const {
  if (motion_ == Motion::kDown) return {kTipsDown, 0};
  // A fin without demand stops where it points: turning it round would take another 0.6 s.
  if (motion_ == Motion::kRest || demands_[fin].amplitude == 0) return {laws_[fin].direction(), 0};
  return demands_[fin];
}

void Fins::read_encoders() {
  measured_us_ = board::microseconds();
  for (uint8_t i = 0; i < kFinCount; ++i) {
    counts_before_[i] = counts_[i];
    const MagneticField field = read_encoder_counts(i, &counts_[i]);
    const bool valid = field != MagneticField::kUnusable;
    assign(&encoder_faults_, i, !valid);
    assign(&yellow_fields_, i, field == MagneticField::kYellow);
    if (valid) angles_[i] = angle_from_counts(fin_calibration(*calibration_, i), counts_[i]);
  }
}

void Fins::power(bool on) {
  silent_bridges_ = 0;
  reported_faults_ = 0;
  phase_ = 0;
  unmixed_ = false;
  for (uint8_t i = 0; i < kFinCount; ++i) {
    if (!on) drive_bridge(i, 0);
    drives_[i] = 0;
    // At rest where they point, so that power alone moves nothing.
    laws_[i].start(angles_[i]);
    loops_[i].restart();
    if (on) watches_[i].restart();
    demands_[i] = {angles_[i], 0};
    set_points_[i] = angles_[i];
  }
  board::set_motor_power(on);
}

// Reads each chip every 400 ms: reading clears a fault, which should be in several of the ten statuses a
// second.
void Fins::read_bridge_faults() {
  fault_read_tick_ = (fault_read_tick_ + 1) % (kFinCount * kTicksPerFaultRead);
  if (fault_read_tick_ % kTicksPerFaultRead) return;
  const uint8_t fin = fault_read_tick_ / kTicksPerFaultRead;
  if (newly_tripped(fin) && !watches_[fin].failed()) watches_[fin].restart();
}

// Once only: a bridge that trips again and again turns its motor as little as a jammed one.
bool Fins::newly_tripped(uint8_t fin) {
  const uint8_t before = reported_faults_;
  assign(&reported_faults_, fin, bridge_failed(fin));
  return reported_faults_ & ~before;
}

void Fins::drive(uint8_t fin, int8_t drive) {
  drives_[fin] = drive;
  assign(&silent_bridges_, fin, !drive_bridge(fin, drive));
}

bool Fins::neutral() const {
  for (const FinLaw& law : laws_) {
    if (law.flapping()) return false;
  }
  return motion_ != Motion::kSwim;
}

uint16_t Fins::faults() const {
  uint16_t bits =
      encoder_faults_ * static_cast<uint16_t>(DeviceFault::kEncoderFrontRight) |
      (silent_bridges_ | reported_faults_) * static_cast<uint16_t>(DeviceFault::kBridgeFrontRight);
  for (uint8_t i = 0; i < kFinCount; ++i) {
    if (watches_[i].failed()) bits |= static_cast<uint16_t>(DeviceFault::kTrackingFrontRight) << i;
  }
  if (yellow_fields_) bits |= static_cast<uint16_t>(DeviceFault::kMagnet);
  return bits;
}

void Fins::report(Motor* packet) const {
  packet->time = measured_us_;
  for (uint8_t i = 0; i < kFinCount; ++i) {
    packet->wanted[i] = lroundf(set_points_[i] * 1000);
    packet->angle[i] = lroundf(angles_[i] * 1000);
    packet->drive[i] = drives_[i];
  }
}

}  // namespace mucat
