#include "loop.h"

#include "sensors/simulated_input.h"

namespace mucat {
namespace {

Sense newest = {};
uint8_t received = 0;

}  // namespace

void accept_simulated_input(const Sense& sense) {
  newest = sense;
  ++received;
}

bool in_the_loop() { return true; }

namespace loop {

const Sense& newest_input() { return newest; }

bool Listener::step() {
  if (received == seen_) {
    if (quiet_ < kLostTicks) ++quiet_;
    return false;
  }
  seen_ = received;
  quiet_ = 0;
  return true;
}

}  // namespace loop
}  // namespace mucat
