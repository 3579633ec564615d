// SPDX-License-Identifier: GPL-3.0-or-later
// The microcontroller: libsimavr's ATmega328P, with what libsimavr 1.6 gets wrong put right.
//
// A reset, the watchdog's included, makes libsimavr forget all its timers, so everything that belongs to the
// world outside the chip keeps time with the timers of this file, which survive.
#ifndef CHIP_H
#define CHIP_H

#include <sim_avr.h>
#include <stdbool.h>
#include <stddef.h>

#define CHIP_FREQUENCY 16000000u

enum chip_reset_cause { CHIP_POWER_ON, CHIP_RESET_PIN };

struct chip_timer {
  struct chip *chip;
  void (*fire)(void *owner);
  void *owner;
  avr_cycle_count_t when;
  bool armed;
  struct chip_timer *next;
};

// Something to do after the chip's program has written to a register.
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
  unsigned long resets;
  unsigned long watchdog_resets;
  unsigned long crashes;
};

// `after_reset` is called after every reset, before the first instruction.
bool chip_create(struct chip *chip, void (*after_reset)(void *owner), void *owner);

// Frees what `chip_create` has made.
void chip_remove(struct chip *chip);

// Takes over what is in the other's flash memory, the boot loader and its fuses too.
void chip_inherit(struct chip *chip, const struct chip *other);

// Puts a program into the flash memory, and leaves a boot loader there; the reset is the caller's. False with
// a reason where it cannot.
bool chip_load(struct chip *chip, const char *elf_path, char *reason, size_t reason_size);

// Puts a boot loader at the end of the flash memory and sets the fuses BOOTSZ and BOOTRST accordingly: from
// now on the chip starts with it. False with a reason where it is none.
bool chip_load_bootloader(struct chip *chip, const char *hex_path, char *reason, size_t reason_size);

void chip_reset(struct chip *chip, enum chip_reset_cause cause);

// Runs to this cycle (give or take one instruction), or until a timer calls `chip_interrupt`.
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

// The timer that libsimavr itself keeps for one of its modules, or NULL.
avr_cycle_timer_slot_p chip_module_timer(const struct chip *chip, const void *module);

#endif
