// What the chip has seen on the line, and how it tells.
#pragma once

#include <Arduino.h>

#include "parameters.h"

constexpr uint8_t PACKET_START = '~';
constexpr uint8_t PACKET_END = '\n';
constexpr uint8_t TEST_MSG = 0x01;
constexpr uint8_t REQUEST_RESULT = 0x02;
constexpr uint8_t CHECKSUM_BYTES = 4;

// Two bytes each; no test sends so much that one of them overflows.
struct Counts {
  uint16_t right = 0;
  uint16_t out_of_sequence = 0;
  uint16_t checksum_errors = 0;
  uint16_t framing_errors = 0;
  uint16_t ring_full = 0;
  uint16_t bytes_read = 0;

  // A number is right when it belongs to the test and is above all right ones before it.
  void take(uint16_t number) {
    if (number >= next_ && number < COMM_TEST_TO) {
      right++;
      next_ = number + 1;
    } else {
      out_of_sequence++;
    }
  }

 private:
  uint16_t next_ = COMM_TEST_FROM;
};

// The packet of Figure 9, sent byte by byte: the checksum is the XOR of type and data, as four bytes.
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

// Hexadecimal digits, because neither mark of a packet can be among them.
inline void put_hexadecimal(PacketWriter &writer, uint16_t value) {
  for (int8_t shift = 12; shift >= 0; shift -= 4) {
    writer.put((uint8_t) "0123456789abcdef"[value >> shift & 0xf]);
  }
}

// The same answer in every framing.
inline void tell(const Counts &counts) {
  PacketWriter writer(REQUEST_RESULT);
  const uint16_t values[] = {counts.right,          counts.out_of_sequence, counts.checksum_errors,
                             counts.framing_errors, counts.ring_full,       counts.bytes_read};
  for (uint16_t value : values) {
    put_hexadecimal(writer, value);
  }
  writer.end();
}
