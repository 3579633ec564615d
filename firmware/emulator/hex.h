// SPDX-License-Identifier: GPL-3.0-or-later
// Intel HEX files.
#ifndef HEX_H
#define HEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Writes the file's data into `memory`; `lowest` becomes its lowest address. False with a reason if the file
// is not an Intel HEX file, is empty, or does not fit.
bool hex_read(const char *path, uint8_t *memory, size_t size, size_t *lowest, char *reason,
              size_t reason_size);

#endif
