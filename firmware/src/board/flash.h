// Constants in flash, which an AVR reads by special instructions; on a host they are ordinary memory.
#pragma once
#include <stdint.h>

#ifdef __AVR__
#include <avr/pgmspace.h>
#else
#define PROGMEM
#define PSTR(text) (text)
inline uint8_t pgm_read_byte(const void* at) { return *static_cast<const uint8_t*>(at); }
inline uint16_t pgm_read_word(const void* at) { return *static_cast<const uint16_t*>(at); }
inline uint32_t pgm_read_dword(const void* at) { return *static_cast<const uint32_t*>(at); }
#endif

namespace mucat {

// A zero-terminated text in flash; a type of its own, so that it is not confused with a text in RAM.
struct FlashText {
  // No braces: PSTR within braces makes avr-gcc 5.4 fail at link time.
  explicit FlashText(const char* text) : at(text) {}
  const char* at;
};

}  // namespace mucat

#define FLASH_TEXT(text) (::mucat::FlashText(PSTR(text)))
