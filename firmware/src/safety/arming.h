// Whether the fins may move: arming, its refusal, and what takes it away.
//
// Armed only by a START that names this boot, after 500 ms of steady traffic from a host built from the same
// packet definitions. 250 ms after the last NAVIGATION the fins are to stop; 1 s after the last valid frame
// the board disarms; STOP disarms at once. Ages are judged at every tick, so that none can wrap around
// unseen.
#pragma once
#include <stdint.h>

#include "board/flash.h"
#include "packets.gen.h"

namespace mucat {

enum class Refusal : uint8_t { kNone, kNoHello, kDefinitions, kEpoch, kTraffic, kBattery };
enum class Disarming : uint8_t { kNone, kStop, kSilence, kBattery, kDefinitions, kHost };

FlashText describe(Refusal refusal);
FlashText describe(Disarming reason);

class Arming {
 public:
  void begin(uint16_t epoch) { epoch_ = epoch; }

  // A valid frame came, whatever is in it.
  void note_reception(uint32_t now_ms);
  // The calls below return why the board disarmed, or kNone if it did not.
  Disarming greet(const Hello& hello);
  Disarming stop() { return disarm(Disarming::kStop); }
  Disarming fail_battery();
  Disarming tick(uint32_t now_ms);

  Refusal start(const Start& start, uint32_t now_ms);
  // Whether the command may be followed.
  bool navigate(uint32_t now_ms);

  bool armed() const { return armed_; }
  bool host_alive() const { return alive_; }
  bool greeted() const { return greeted_; }
  bool definitions_differ() const { return greeted_ && !agreed_; }
  // Whether a command came lately enough to be followed.
  bool commanded() const { return armed_ && commanded_; }

 private:
  Disarming disarm(Disarming reason);
  Refusal refusal(const Start& start, uint32_t now_ms) const;

  uint32_t received_ms_ = 0;
  uint32_t steady_since_ms_ = 0;
  uint32_t commanded_ms_ = 0;
  uint16_t epoch_ = 0;
  uint16_t host_epoch_ = 0;
  bool greeted_ = false;
  bool agreed_ = false;
  bool alive_ = false;
  bool commanded_ = false;
  bool armed_ = false;
  bool battery_failed_ = false;
};

}  // namespace mucat
