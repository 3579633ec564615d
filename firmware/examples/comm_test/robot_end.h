// The chip's end of the robot's own link, with the robot's library and its port instead of Serial: both have
// the same interrupts. The link is kept alive while the sketch waits. It takes the host's numbers only while
// there is room for a frame full of them, so that none is acknowledged that could be lost.
#pragma once

#include <mucat.h>

#include "board/avr/parts.h"
#include "board/board.h"
#include "counts.h"
#include "link/baud.h"
#include "link/link.h"

static_assert(mucat::kBaud == COMM_TEST_BAUD, "compile the library for this baud as well: -DMUCAT_BAUD=...");

class RobotEnd {
 public:
  void start() {
    mucat::board::start_line();
    epoch_ = mucat::board::next_epoch();
    link_.greet(epoch_);
  }

  // Whether the host has sent a number.
  bool heard() const { return heard_; }

  // The oldest number that came. The question is the last that comes, and waits for them.
  Event receive(Counts &counts) {
    poll();
    if (held_) {
      counts.take(numbers_[first_]);
      first_ = (first_ + 1) % NUMBERS_MAX;
      held_--;
      return MESSAGE;
    }
    if (!asked_) {
      return NOTHING;
    }
    asked_ = false;
    return REQUEST;
  }

  void send(uint16_t number) { queue(mucat::TestMsg{number}); }

  void tell(const Counts &counts) {
    queue(mucat::TestResult{counts.right, counts.out_of_sequence, link_.frames_invalid(),
                            link_.frames_repeated(), mucat::board::bytes_lost()});
  }

  void rest() { wait(); }

  void wait() {
    poll();
    mucat::board::rest();
  }

 private:
  static constexpr uint8_t NUMBERS_PER_FRAME =
      mucat::kReliableMessagesBytesMax / (1 + sizeof(mucat::TestMsg));
  static constexpr uint8_t NUMBERS_MAX = 2 * NUMBERS_PER_FRAME;
  static constexpr uint16_t SIGN_OF_LIFE_MS = 400;

  template <typename Packet>
  void queue(const Packet &packet) {
    while (!link_.queue(packet)) {
      wait();
    }
  }

  void poll() {
    do {
      set_ready();
    } while (take_frame());
    const uint16_t now = mucat::board::milliseconds();
    link_.step(now);
    if (greeted_ && now - signed_ms_ >= SIGN_OF_LIFE_MS) {
      signed_ms_ = now;
      link_.acknowledge();
    }
  }

  bool take_frame() {
    const bool valid = link_.receive();
    mucat::Message message;
    while (valid && link_.next(&message)) {
      handle(message);
      // Frames that came before their turn may follow at once.
      set_ready();
    }
    return valid;
  }

  void set_ready() { link_.set_ready(held_ + NUMBERS_PER_FRAME <= NUMBERS_MAX); }

  void handle(const mucat::Message &message) {
    switch (message.type) {
      case mucat::Hello::kType:
        greeted_ = true;
        link_.answer(mucat::unpack<mucat::Hello>(message), epoch_);
        break;
      case mucat::TestMsg::kType:
        heard_ = true;
        numbers_[(first_ + held_++) % NUMBERS_MAX] = mucat::unpack<mucat::TestMsg>(message).number;
        break;
      case mucat::RequestResult::kType:
        asked_ = true;
        break;
      default:
        break;  // a heartbeat
    }
  }

  mucat::Link link_;
  uint16_t numbers_[NUMBERS_MAX];
  uint16_t epoch_ = 0;
  uint16_t signed_ms_ = 0;
  uint8_t first_ = 0;
  uint8_t held_ = 0;
  bool greeted_ = false;
  bool heard_ = false;
  bool asked_ = false;
};
