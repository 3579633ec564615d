#include "safety/arming.h"

namespace mucat {
namespace {

constexpr uint32_t kTrafficMs = 500;
constexpr uint32_t kGapMs = 250;
constexpr uint32_t kCommandMs = 250;
constexpr uint32_t kSilenceMs = 1000;

}  // namespace

void Arming::note_reception(uint32_t now_ms) {
  if (!alive_ || now_ms - received_ms_ > kGapMs) steady_since_ms_ = now_ms;
  received_ms_ = now_ms;
  alive_ = true;
}

Disarming Arming::greet(const Hello& hello) {
  const bool another = greeted_ && hello.epoch != host_epoch_;
  greeted_ = true;
  agreed_ = hello.definitions == kDefinitionsHash;
  host_epoch_ = hello.epoch;
  if (!agreed_) return disarm(Disarming::kDefinitions);
  return another ? disarm(Disarming::kHost) : Disarming::kNone;
}

Disarming Arming::fail_battery() {
  battery_failed_ = true;
  return disarm(Disarming::kBattery);
}

Disarming Arming::fail_leak() {
  leaked_ = true;
  return disarm(Disarming::kLeak);
}

Disarming Arming::tick(uint32_t now_ms) {
  if (commanded_ && now_ms - commanded_ms_ >= kCommandMs) commanded_ = false;
  if (!alive_ || now_ms - received_ms_ < kSilenceMs) return Disarming::kNone;
  alive_ = false;
  return disarm(Disarming::kSilence);
}

Refusal Arming::refusal(const Start& start, bool calibrated, bool surface_certain, uint32_t now_ms) const {
  if (!greeted_) return Refusal::kNoHello;
  if (!agreed_) return Refusal::kDefinitions;
  if (start.epoch != epoch_) return Refusal::kEpoch;
  if (now_ms - steady_since_ms_ < kTrafficMs) return Refusal::kTraffic;
  if (battery_failed_) return Refusal::kBattery;
  if (leaked_) return Refusal::kLeak;
  if (!calibrated) return Refusal::kCalibration;
  if (!surface_certain) return Refusal::kSurface;
  return Refusal::kNone;
}

Refusal Arming::start(const Start& start, bool calibrated, bool surface_certain, uint32_t now_ms) {
  const Refusal reason = refusal(start, calibrated, surface_certain, now_ms);
  if (reason == Refusal::kNone) armed_ = true;
  return reason;
}

bool Arming::navigate(uint32_t now_ms) {
  if (!armed_) return false;
  commanded_ = true;
  commanded_ms_ = now_ms;
  return true;
}

Disarming Arming::disarm(Disarming reason) {
  commanded_ = false;
  if (!armed_) return Disarming::kNone;
  armed_ = false;
  return reason;
}

}  // namespace mucat
