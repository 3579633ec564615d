// The boot counter in EEPROM, which survives a power cycle. Its cells last for 100,000 boots.
#ifdef __AVR__
#include <avr/eeprom.h>

#include "board/board.h"

namespace mucat {
namespace board {

uint16_t next_epoch() {
  uint16_t* const address = nullptr;
  uint16_t epoch = eeprom_read_word(address) + 1;
  if (epoch == 0) epoch = 1;
  eeprom_update_word(address, epoch);
  return epoch;
}

}  // namespace board
}  // namespace mucat
#endif
