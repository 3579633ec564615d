#include "loop.h"

#include "sensors/sense.h"

namespace mucat {
namespace {

Sense newest = {};
uint8_t words = 0;

}  // namespace

void feel(const Sense& sense) {
  newest = sense;
  ++words;
}

bool in_the_loop() { return true; }

namespace loop {

const Sense& sense() { return newest; }

bool Listener::step() {
  if (words == seen_) {
    if (quiet_ < kLostTicks) ++quiet_;
    return false;
  }
  seen_ = words;
  quiet_ = 0;
  return true;
}

}  // namespace loop
}  // namespace mucat
