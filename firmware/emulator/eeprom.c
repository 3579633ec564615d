// SPDX-License-Identifier: GPL-3.0-or-later
#include "eeprom.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "calibration.gen.h"
#include "registers.h"

#define WRITE_SECONDS 3.4e-3

static void on_written(void *owner) {
  struct eeprom *eeprom = owner;
  eeprom->chip->avr->data[REGISTER_EECR] &= (uint8_t)~EECR_EEPE;
}

// EEPE stays set until the write is done; programs wait for that.
static void on_control_written(void *owner, uint8_t value) {
  (void)value;
  struct eeprom *eeprom = owner;
  avr_cycle_count_t end = chip_now(eeprom->chip) + chip_cycles(WRITE_SECONDS);
  avr_cycle_timer_slot_p slot = chip_module_timer(eeprom->chip, eeprom->module);
  while (slot && (slot->param != eeprom->module || slot->when != end)) {
    slot = slot->next;
  }
  if (slot) {
    chip_timer_start(&eeprom->written, end);
  }
  if (eeprom->written.armed) {
    eeprom->chip->avr->data[REGISTER_EECR] |= EECR_EEPE;
  }
}

void eeprom_create(struct eeprom *eeprom, struct chip *chip) {
  *eeprom = (struct eeprom){.chip = chip, .module = chip_module(chip, "eeprom")};
  chip_timer_add(chip, &eeprom->written, on_written, eeprom);
  chip_hook_write(chip, REGISTER_EECR, &eeprom->control_written, on_control_written, eeprom);
}

void eeprom_copy(struct eeprom *eeprom, const struct eeprom *other) {
  free(eeprom->module->eeprom);
  eeprom->module->eeprom = other->module->eeprom;
  other->module->eeprom = NULL;
}

static bool prepare_file(int file, size_t size) {
  struct stat status;
  if (fstat(file, &status)) {
    return false;
  }
  if (status.st_size) {
    errno = EINVAL;
    return (size_t)status.st_size == size;
  }
  uint8_t erased[4096];
  memset(erased, 0xff, sizeof erased);
  return size <= sizeof erased && write(file, erased, size) == (ssize_t)size;
}

bool eeprom_open(struct eeprom *eeprom, const char *path, char *reason, size_t reason_size) {
  size_t size = eeprom->module->size;
  int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  bool ready = file >= 0 && prepare_file(file, size);
  void *memory = ready ? mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
  if (memory == MAP_FAILED) {
    const char *why = errno == EINVAL ? "not an EEPROM of this chip" : strerror(errno);
    snprintf(reason, reason_size, "cannot keep the EEPROM in %s: %s", path, why);
  } else {
    // Every byte that the program writes is in the file at once, even if this process is killed.
    free(eeprom->module->eeprom);
    eeprom->module->eeprom = memory;
  }
  if (file >= 0) {
    close(file);
  }
  return memory != MAP_FAILED;
}

static uint32_t crc32(const uint8_t *bytes, unsigned size) {
  uint32_t crc = 0xffffffff;
  for (unsigned i = 0; i < 8 * size; i++) {
    bool bit = (crc ^ bytes[i / 8] >> i % 8) & 1;
    crc = crc >> 1 ^ (bit ? 0xedb88320 : 0);
  }
  return ~crc;
}

// A record ends with the CRC-32 of all before, so that the CRC-32 of every whole one is the same.
static bool calibrated(const uint8_t *record) {
  return record[0] == calibration_record[0] &&
         crc32(record, CALIBRATION_BYTES) == crc32(calibration_record, CALIBRATION_BYTES);
}

void eeprom_calibrate(struct eeprom *eeprom) {
  uint8_t *record = eeprom->module->eeprom + CALIBRATION_ADDRESS;
  if (!calibrated(record)) {
    memcpy(record, calibration_record, CALIBRATION_BYTES);
  }
}
