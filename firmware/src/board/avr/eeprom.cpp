// The EEPROM, which survives a power cycle: boot counter at 0, calibration at 16, surface at 48, and 255 more
// boots from 256 on. A cell lasts for 100,000 writes, which boots four times a second would make in 7 hours:
// so each boot writes another one, and a cell lasts for 74 days of them.
#ifdef __AVR__
#include <avr/eeprom.h>

#include "board/board.h"

namespace mucat {
namespace board {
namespace {

uint16_t* const kEpochAddress = nullptr;
uint16_t* const kNextEpochs = reinterpret_cast<uint16_t*>(256);
constexpr uint8_t kNextEpochsRoom = 255;
uint8_t* const kRecordsAddress = reinterpret_cast<uint8_t*>(16);

}  // namespace

uint16_t next_epoch() {
  uint16_t epoch = eeprom_read_word(kEpochAddress) + 1;
  uint8_t boots = 0;
  while (boots < kNextEpochsRoom && eeprom_read_word(kNextEpochs + boots) == epoch) {
    ++boots;
    ++epoch;
  }
  const bool full = boots == kNextEpochsRoom || epoch == 0;
  if (epoch == 0) epoch = 1;
  eeprom_update_word(full ? kEpochAddress : kNextEpochs + boots, epoch);
  return epoch;
}

void read_eeprom(uint8_t index, void* bytes, uint8_t size) {
  eeprom_read_block(bytes, kRecordsAddress + index, size);
}

void write_eeprom(uint8_t index, uint8_t byte) { eeprom_update_byte(kRecordsAddress + index, byte); }

}  // namespace board
}  // namespace mucat
#endif
