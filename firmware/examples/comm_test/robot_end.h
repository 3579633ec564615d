// The chip's end of the robot's own link, with the robot's library and its port instead of Serial: both use
// the same interrupts. The link is served while the sketch waits. It accepts the host's numbers only while
// there is room for a full frame, so that no acknowledged number can be lost.
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

  // True if the host has sent a number.
  bool heard() const { return heard_; }

  // Handles the oldest stored number. The request is handled after all numbers.
  Event receive(Counts &counts) {
    poll();
    if (stored_) {
      counts.count(numbers_[first_]);
      first_ = (first_ + 1) % NUMBERS_MAX;
      stored_--;
      return MESSAGE;
    }
    if (!requested_) {
      return NOTHING;
    }
    requested_ = false;
    return REQUEST;
  }

  void send(uint16_t number) { queue(mucat::TestMsg{number}); }

  void send_result(const Counts &counts) {
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
  static constexpr uint16_t ACKNOWLEDGE_PERIOD_MS = 400;

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
    if (greeted_ && now - acknowledged_ms_ >= ACKNOWLEDGE_PERIOD_MS) {
      acknowledged_ms_ = now;
      link_.acknowledge();
    }
  }

  bool take_frame() {
    const bool valid = link_.receive();
    mucat::Message message;
    while (valid && link_.next(&message)) {
      handle(message);
      // Stored frames may follow at once.
      set_ready();
    }
    return valid;
  }

  void set_ready() { link_.set_ready(stored_ + NUMBERS_PER_FRAME <= NUMBERS_MAX); }

  void handle(const mucat::Message &message) {
    switch (message.type) {
      case mucat::Hello::kType:
        greeted_ = true;
        link_.answer(mucat::unpack<mucat::Hello>(message), epoch_);
        break;
      case mucat::TestMsg::kType:
        heard_ = true;
        numbers_[(first_ + stored_++) % NUMBERS_MAX] = mucat::unpack<mucat::TestMsg>(message).number;
        break;
      case mucat::RequestResult::kType:
        requested_ = true;
        break;
      default:
        break;  // a heartbeat
    }
  }

  mucat::Link link_;
  uint16_t numbers_[NUMBERS_MAX];
  uint16_t epoch_ = 0;
  uint16_t acknowledged_ms_ = 0;
  uint8_t first_ = 0;
  uint8_t stored_ = 0;
  bool greeted_ = false;
  bool heard_ = false;
  bool requested_ = false;
};
