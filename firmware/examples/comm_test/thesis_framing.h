// The packet of the thesis (Figure 9, Table 4): ~ T D0 D1 CS0 CS1 CS2 CS3 \n, without length and stuffing.
// The end mark ends a packet wherever it is; a start mark within a packet is an ordinary byte.
#pragma once

#include "counts.h"
#include "thesis_packet.h"

class ThesisFraming {
 public:
  Event take(uint8_t byte, Counts &counts) {
    counts.bytes_read++;
    if (!inside_) {
      inside_ = byte == PACKET_START;
      length_ = 0;
      return NOTHING;
    }
    if (byte != PACKET_END) {
      store(byte);
      return NOTHING;
    }
    inside_ = false;
    return finish(counts);
  }

  static void send(uint16_t number) {
    PacketWriter writer(TEST_MSG);
    writer.put((uint8_t)(number >> 8));
    writer.put((uint8_t)number);
    writer.end();
  }

 private:
  static constexpr uint8_t MESSAGE_BYTES = 1 + 2 + CHECKSUM_BYTES;
  static constexpr uint8_t REQUEST_BYTES = 1 + CHECKSUM_BYTES;
  static constexpr uint8_t MARKS = 2;

  void store(uint8_t byte) {
    if (length_ < MESSAGE_BYTES) {
      packet_[length_] = byte;
    }
    if (length_ <= MESSAGE_BYTES) {
      length_++;
    }
  }

  Event finish(Counts &counts) {
    if (length_ == REQUEST_BYTES && packet_[0] == REQUEST_RESULT && checked()) {
      counts.bytes_read -= REQUEST_BYTES + MARKS;
      return REQUEST;
    }
    if (length_ != MESSAGE_BYTES || packet_[0] != TEST_MSG) {
      counts.framing_errors++;
    } else if (!checked()) {
      counts.checksum_errors++;
    } else {
      counts.count((uint16_t)(packet_[1] << 8 | packet_[2]));
    }
    return MESSAGE;
  }

  bool checked() const {
    uint8_t content = length_ - CHECKSUM_BYTES;
    uint8_t checksum = 0;
    for (uint8_t i = 0; i < content; i++) {
      checksum ^= packet_[i];
    }
    for (uint8_t i = content; i < length_ - 1; i++) {
      if (packet_[i]) {
        return false;
      }
    }
    return packet_[length_ - 1] == checksum;
  }

  uint8_t packet_[MESSAGE_BYTES];
  uint8_t length_ = 0;
  bool inside_ = false;
};
