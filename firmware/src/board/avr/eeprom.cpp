// The EEPROM, which survives a power cycle: boot counter at 0, calibration at 16, surface at 48. A cell lasts
// for 100,000 writes.
#ifdef __AVR__
#include <avr/eeprom.h>

#include "board/board.h"

namespace mucat {
namespace board {
namespace {

uint16_t* const kEpochAddress = nullptr;
uint8_t* const kRecordsAddress = reinterpret_cast<uint8_t*>(16);

}  // namespace

uint16_t next_epoch() {
  uint16_t epoch = eeprom_read_word(kEpochAddress) + 1;
  if (epoch == 0) epoch = 1;
  eeprom_update_word(kEpochAddress, epoch);
  return epoch;
}

void read_eeprom(uint8_t index, void* bytes, uint8_t size) {
  eeprom_read_block(bytes, kRecordsAddress + index, size);
}

void write_eeprom(uint8_t index, uint8_t byte) { eeprom_update_byte(kRecordsAddress + index, byte); }

}  // namespace board
}  // namespace mucat
#endif
