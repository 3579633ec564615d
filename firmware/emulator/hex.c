// SPDX-License-Identifier: GPL-3.0-or-later
#include "hex.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define RECORD_BYTES_MAX 260  // count, address, type, 255 bytes, checksum
#define LINE_MAX (2 * RECORD_BYTES_MAX + 8)
#define HEAD_BYTES 4

enum record_type { DATA, END, SEGMENT = 2, LINEAR = 4 };

struct record {
  uint8_t bytes[RECORD_BYTES_MAX];
  size_t count;
};

// True if the line is one complete record with the right checksum.
static bool read_record(const char *line, struct record *record) {
  if (*line++ != ':') {
    return false;
  }
  uint8_t sum = 0;
  record->count = 0;
  for (unsigned value; record->count < RECORD_BYTES_MAX && sscanf(line, "%2x", &value) == 1; line += 2) {
    record->bytes[record->count++] = (uint8_t)value;
    sum = (uint8_t)(sum + value);
  }
  bool ended = !line[strspn(line, "\r\n")];
  return ended && sum == 0 && record->count > HEAD_BYTES &&
         record->count == HEAD_BYTES + 1u + record->bytes[0];
}

static size_t word(const uint8_t *bytes) { return (size_t)(bytes[0] << 8 | bytes[1]); }

// The number of the first wrong line, or 0; `lowest` does not change without data.
static unsigned read_records(FILE *file, uint8_t *memory, size_t size, size_t *lowest) {
  char line[LINE_MAX];
  size_t base = 0;
  for (unsigned number = 1; fgets(line, sizeof line, file); number++) {
    struct record record;
    if (!read_record(line, &record)) {
      return number;
    }
    const uint8_t *content = record.bytes + HEAD_BYTES;
    size_t count = record.bytes[0], address = base + word(record.bytes + 1);
    if (record.bytes[3] == END) {
      return 0;
    }
    if (record.bytes[3] == DATA && count) {
      if (address + count > size) {
        return number;
      }
      memcpy(memory + address, content, count);
      *lowest = address < *lowest ? address : *lowest;
    } else if (record.bytes[3] == SEGMENT && count == 2) {
      base = word(content) << 4;
    } else if (record.bytes[3] == LINEAR && count == 2) {
      base = word(content) << 16;
    }
  }
  return 0;
}

bool hex_read(const char *path, uint8_t *memory, size_t size, size_t *lowest, char *reason,
              size_t reason_size) {
  FILE *file = fopen(path, "r");
  if (!file) {
    snprintf(reason, reason_size, "cannot read %s: %s", path, strerror(errno));
    return false;
  }
  *lowest = size;
  unsigned wrong = read_records(file, memory, size, lowest);
  fclose(file);
  if (wrong) {
    snprintf(reason, reason_size, "%s: line %u is no Intel HEX record for this chip", path, wrong);
  } else if (*lowest == size) {
    snprintf(reason, reason_size, "%s holds no program", path);
  }
  return !wrong && *lowest < size;
}
