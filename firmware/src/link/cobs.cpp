#include "link/cobs.h"

namespace mucat {

uint8_t encode_cobs(const uint8_t* bytes, uint8_t size, uint8_t* out) {
  uint8_t code_at = 0;
  for (uint8_t i = 0; i < size; ++i) {
    out[i + 1] = bytes[i];
    if (bytes[i] == 0) {
      out[code_at] = i + 1 - code_at;
      code_at = i + 1;
    }
  }
  out[code_at] = size + 1 - code_at;
  return size + 1;
}

uint8_t decode_cobs(uint8_t* bytes, uint8_t size) {
  if (size < 2) return 0;
  uint8_t zero_at = 0;
  while (zero_at < size) {
    const uint8_t code = bytes[zero_at];
    if (code == 0 || code > size - zero_at) return 0;
    bytes[zero_at] = 0;
    zero_at += code;
  }
  // Every code is now the zero it replaced; the first code replaced none.
  for (uint8_t i = 1; i < size; ++i) bytes[i - 1] = bytes[i];
  return size - 1;
}

}  // namespace mucat
