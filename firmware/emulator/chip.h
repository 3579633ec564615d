// SPDX-License-Identifier: GPL-3.0-or-later
// The microcontroller: libsimavr's ATmega328P, with the errors of libsimavr 1.6 corrected.
//
// A reset, the watchdog's included, drops all of libsimavr's timers. So everything outside the chip uses the
// timers of this file, which survive a reset.
#ifndef CHIP_H
#define CHIP_H

#include <sim_avr.h>
#include <stdbool.h>
#include <stddef.h>

#define CHIP_FREQUENCY 16000000u

enum chip_reset_cause { CHIP_POWER_ON, CHIP_RESET_PIN, CHIP_BROWN_OUT };

struct chip_timer {
  struct chip *chip;
  void (*fire)(void *owner);
  void *owner;
  avr_cycle_count_t when;
  bool armed;
  struct chip_timer *next;
};

// An action after the chip's program has written to a register.
struct chip_write_hook {
  avr_io_write_t inner;
  void *inner_param;
  void (*after)(void *owner, uint8_t value);
  void *owner;
};

struct chip {
  avr_t *avr;
  void (*core_reset)(avr_t *avr);
  void (*after_reset)(void *owner);
  void *owner;
  struct chip_timer *timers;
  struct chip_timer run_end;
  bool was_reset;
  bool interrupted;
  uint32_t random;
  unsigned long resets;
  unsigned long watchdog_resets;
  unsigned long crashes;
};

// `after_reset` is called after every reset, before the first instruction.
bool chip_create(struct chip *chip, void (*after_reset)(void *owner), void *owner);

// Frees everything that `chip_create` allocated.
void chip_remove(struct chip *chip);

// Copies the other's flash memory, the boot loader and its fuses too.
void chip_copy_flash(struct chip *chip, const struct chip *other);

// Writes a program into the flash memory; a boot loader stays. The caller resets the chip. False with a
// reason on failure.
bool chip_load(struct chip *chip, const char *elf_path, char *reason, size_t reason_size);

// Writes a boot loader to the end of the flash memory and sets the fuses BOOTSZ and BOOTRST: from now on the
// chip starts with it. False with a reason if the file is not a boot loader.
bool chip_load_bootloader(struct chip *chip, const char *hex_path, char *reason, size_t reason_size);

void chip_reset(struct chip *chip, enum chip_reset_cause cause);

// A brown-out: a reset after which this share of the memory's bytes, 0 to 1, is random.
void chip_brown_out(struct chip *chip, double lost);

// Runs to this cycle (to within one instruction), or until a timer calls `chip_interrupt`.
void chip_run(struct chip *chip, avr_cycle_count_t until);
void chip_interrupt(struct chip *chip);

avr_cycle_count_t chip_now(const struct chip *chip);
avr_cycle_count_t chip_cycles(double seconds);
double chip_seconds(avr_cycle_count_t cycles);

void chip_timer_add(struct chip *chip, struct chip_timer *timer, void (*fire)(void *owner), void *owner);
void chip_timer_start(struct chip_timer *timer, avr_cycle_count_t when);
void chip_timer_stop(struct chip_timer *timer);

void chip_hook_write(struct chip *chip, avr_io_addr_t address, struct chip_write_hook *hook,
                     void (*after)(void *owner, uint8_t value), void *owner);

// libsimavr's module of this kind, such as "uart".
void *chip_module(const struct chip *chip, const char *kind);

// libsimavr's own timer for one of its modules, or NULL.
avr_cycle_timer_slot_p chip_module_timer(const struct chip *chip, const void *module);

#endif
