// Arming, its refusal, and disarming: the conditions under which the fins may move.
//
// Armed only by a START that names this boot, after 500 ms of steady traffic from a host built from the same
// packet definitions. 250 ms after the last NAVIGATION the fins stop; 1 s after the last valid frame the
// board disarms; STOP disarms at once. Every tick checks these ages, so that they cannot wrap around
// unnoticed. That of the traffic can: after 50 days of it START is refused for half a second, and the host
// asks again.
#pragma once
#include <stdint.h>

#include "packets.gen.h"

namespace mucat {

class Arming {
 public:
  void begin(uint16_t epoch) { epoch_ = epoch; }

  // Notes that a valid frame came, with any content.
  void note_reception(uint32_t now_ms);
  // The calls below return why the board disarmed, or kNone if it did not.
  Disarming greet(const Hello& hello);
  Disarming stop() { return disarm(Disarming::kStop); }
  Disarming fail_battery();
  Disarming fail_leak();
  Disarming tick(uint32_t now_ms);

  Refusal start(const Start& start, bool calibrated, bool surface_certain, uint32_t now_ms);
  // True if the command may be carried out.
  bool navigate(uint32_t now_ms);

  bool armed() const { return armed_; }
  bool host_alive() const { return alive_; }
  bool greeted() const { return greeted_; }
  // True if the host has greeted, and was built from the same packet definitions.
  bool agreed() const { return agreed_; }
  bool definitions_differ() const { return greeted_ && !agreed_; }
  // True if the last command is recent enough.
  bool commanded() const { return armed_ && commanded_; }

 private:
  Disarming disarm(Disarming reason);
  Refusal refusal(const Start& start, bool calibrated, bool surface_certain, uint32_t now_ms) const;

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
  bool leaked_ = false;
};

}  // namespace mucat
