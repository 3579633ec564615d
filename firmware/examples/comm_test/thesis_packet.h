// The packet of the thesis's Figure 9, sent byte by byte: the checksum is the XOR of type and data, as four
// bytes. The result is such a packet in both framings of the thesis.
#pragma once

#include <Arduino.h>

#include "counts.h"

constexpr uint8_t PACKET_START = '~';
constexpr uint8_t PACKET_END = '\n';
constexpr uint8_t TEST_MSG = 0x01;
constexpr uint8_t REQUEST_RESULT = 0x02;
constexpr uint8_t CHECKSUM_BYTES = 4;

class PacketWriter {
 public:
  explicit PacketWriter(uint8_t type) : checksum_(type) {
    Serial.write(PACKET_START);
    Serial.write(type);
  }

  void put(uint8_t byte) {
    checksum_ ^= byte;
    Serial.write(byte);
  }

  void end() {
    for (uint8_t i = 1; i < CHECKSUM_BYTES; i++) {
      Serial.write((uint8_t)0);
    }
    Serial.write(checksum_);
    Serial.write(PACKET_END);
  }

 private:
  uint8_t checksum_;
};

// Writes hexadecimal digits: none of them is a mark of a packet.
inline void put_hexadecimal(PacketWriter &writer, uint16_t value) {
  for (int8_t shift = 12; shift >= 0; shift -= 4) {
    writer.put((uint8_t) "0123456789abcdef"[value >> shift & 0xf]);
  }
}

inline void send_result(const Counts &counts) {
  PacketWriter writer(REQUEST_RESULT);
  const uint16_t values[] = {counts.right,          counts.out_of_sequence, counts.checksum_errors,
                             counts.framing_errors, counts.ring_full,       counts.bytes_read};
  for (uint16_t value : values) {
    put_hexadecimal(writer, value);
  }
  writer.end();
}
