// SPDX-License-Identifier: GPL-3.0-or-later
#include "chip.h"

#include <avr_extint.h>
#include <avr_timer.h>
#include <elf.h>
#include <errno.h>
#include <sim_core.h>
#include <sim_elf.h>
#include <sim_regbit.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hex.h"

// Cycles after which libsimavr checks its timers at the latest; a reset clears this number.
#define RUN_CYCLES_MAX 16000

#define BOOT_SECTION_MIN 512  // bytes; the fuses BOOTSZ choose one of four sizes
#define BOOT_SECTION_MAX 4096

static void log_nothing(avr_t *avr, const int level, const char *format, va_list arguments) {
  (void)avr, (void)level, (void)format, (void)arguments;
}

// Emulated time skips the chip's sleep; the caller paces the chip.
static void sleep_without_waiting(avr_t *avr, avr_cycle_count_t cycles) { (void)avr, (void)cycles; }

static void timer_fired(struct chip_timer *timer) {
  timer->armed = false;
  timer->fire(timer->owner);
}

static avr_cycle_count_t on_timer(avr_t *avr, avr_cycle_count_t when, void *param) {
  (void)avr, (void)when;
  timer_fired(param);
  return 0;
}

static void register_timer(struct chip_timer *timer) {
  avr_t *avr = timer->chip->avr;
  avr_cycle_count_t delay = timer->when > avr->cycle ? timer->when - avr->cycle : 1;
  avr_cycle_timer_register(avr, delay, on_timer, timer);
}

// Called by libsimavr within every reset, right after it has dropped all timers.
static void on_reset(avr_t *avr) {
  struct chip *chip = avr->custom.data;
  if (chip->core_reset) {
    chip->core_reset(avr);
  }
  avr->run_cycle_limit = RUN_CYCLES_MAX;
  for (struct chip_timer *timer = chip->timers; timer; timer = timer->next) {
    if (timer->armed) {
      register_timer(timer);
    }
  }
  chip->was_reset = true;
}

static void finish_reset(struct chip *chip) {
  chip->was_reset = false;
  chip->resets++;
  if (avr_regbit_get(chip->avr, chip->avr->reset_flags.wdrf)) {
    chip->watchdog_resets++;
  }
  // Otherwise a low INT0 or INT1 pin costs a call in every cycle.
  avr_extint_set_strict_lvl_trig(chip->avr, 0, 0);
  avr_extint_set_strict_lvl_trig(chip->avr, 1, 0);
  chip->after_reset(chip->owner);
}

static void on_run_end(void *owner) {
  (void)owner;  // the timer only stops libsimavr from running or sleeping past this cycle
}

// libsimavr does not know phase-correct PWM of 8, 9 and 10 bits, which Arduino's core starts in timers 1 and
// 2, and lets a timer overflow at every one of its clocks instead: most of an idle chip's time. Such a timer
// counts up and down, so that it overflows once in nearly as many clocks as fast PWM of one bit more.
static void add_phase_correct_pwm(avr_t *avr) {
  for (avr_io_t *io = avr->io_port; io; io = io->next) {
    avr_timer_t *timer = (avr_timer_t *)io;
    if (strcmp(io->kind, "timer")) {
      continue;
    }
    for (unsigned mode = 1; mode <= (timer->r_tcnth ? 3 : 1); mode++) {
      timer->wgm_op[mode] = (avr_timer_wgm_t){.kind = avr_timer_wgm_fast_pwm, .size = 8 + mode};
    }
  }
}

static uint32_t next_random(struct chip *chip) {
  chip->random ^= chip->random << 13;
  chip->random ^= chip->random >> 17;
  chip->random ^= chip->random << 5;
  return chip->random;
}

// Memory without power is neither zero nor what it was, and the same at each start of a board.
static void scramble_memory(struct chip *chip, double lost) {
  avr_t *avr = chip->avr;
  for (avr_io_addr_t at = avr->ioend + 1; at <= avr->ramend; at++) {
    if (next_random(chip) <= lost * UINT32_MAX) {
      avr->data[at] = (uint8_t)next_random(chip);
    }
  }
}

bool chip_create(struct chip *chip, void (*after_reset)(void *owner), void *owner) {
  avr_global_logger_set(log_nothing);
  avr_t *avr = avr_make_mcu_by_name("atmega328p");
  if (!avr || avr_init(avr)) {
    return false;
  }
  avr->frequency = CHIP_FREQUENCY;
  avr->vcc = avr->avcc = avr->aref = 5000;
  avr->sleep = sleep_without_waiting;
  add_phase_correct_pwm(avr);
  avr->custom.data = chip;
  chip->avr = avr;
  chip->random = 0x2545F491;
  scramble_memory(chip, 1);
  chip->core_reset = avr->reset;
  avr->reset = on_reset;
  chip->after_reset = after_reset;
  chip->owner = owner;
  chip_timer_add(chip, &chip->run_end, on_run_end, chip);
  return true;
}

void chip_remove(struct chip *chip) {
  avr_terminate(chip->avr);
  free(chip->avr);
}

void chip_copy_flash(struct chip *chip, const struct chip *other) {
  memcpy(chip->avr->flash, other->avr->flash, other->avr->flashend + 1);
  chip->avr->reset_pc = other->avr->reset_pc;
}

static bool check_elf(const char *path, char *reason, size_t size) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    snprintf(reason, size, "cannot read %s: %s", path, strerror(errno));
    return false;
  }
  Elf32_Ehdr header;
  bool whole = fread(&header, sizeof header, 1, file) == 1;
  fclose(file);
  if (!whole || memcmp(header.e_ident, ELFMAG, SELFMAG) || header.e_ident[EI_CLASS] != ELFCLASS32 ||
      header.e_machine != EM_AVR) {
    snprintf(reason, size, "%s is not an ELF file for an AVR", path);
    return false;
  }
  return true;
}

// The flash memory without the boot loader's section.
static uint32_t application_size(const struct chip *chip) {
  return chip->avr->reset_pc ? chip->avr->reset_pc : chip->avr->flashend + 1;
}

bool chip_load(struct chip *chip, const char *elf_path, char *reason, size_t reason_size) {
  if (!check_elf(elf_path, reason, reason_size)) {
    return false;
  }
  avr_t *avr = chip->avr;
  elf_firmware_t firmware = {0};
  if (elf_read_firmware(elf_path, &firmware) || !firmware.flash || !firmware.flashsize) {
    snprintf(reason, reason_size, "%s holds no program", elf_path);
    return false;
  }
  uint32_t room = application_size(chip);
  bool fits = firmware.flashbase + firmware.flashsize <= room;
  if (fits) {
    memset(avr->flash, 0xff, room);
    firmware.frequency = CHIP_FREQUENCY;
    firmware.eesize = 0;  // an upload does not change the EEPROM
    avr_load_firmware(avr, &firmware);
  } else {
    snprintf(reason, reason_size, "%s reaches up to 0x%04x; programs have the flash memory below 0x%04x",
             elf_path, firmware.flashbase + firmware.flashsize, room);
  }
  free(firmware.flash);
  free(firmware.eeprom);
  return fits;
}

bool chip_load_bootloader(struct chip *chip, const char *hex_path, char *reason, size_t reason_size) {
  avr_t *avr = chip->avr;
  size_t flash_size = avr->flashend + 1, start;
  if (!hex_read(hex_path, avr->flash, flash_size, &start, reason, reason_size)) {
    return false;
  }
  for (size_t section = BOOT_SECTION_MIN; section <= BOOT_SECTION_MAX; section *= 2) {
    if (start == flash_size - section) {
      avr->reset_pc = (uint32_t)start;
      return true;
    }
  }
  snprintf(reason, reason_size,
           "%s is no boot loader of this chip: it begins at 0x%04zx, and those begin at 0x7e00, 0x7c00, "
           "0x7800 or 0x7000",
           hex_path, start);
  return false;
}

void chip_reset(struct chip *chip, enum chip_reset_cause cause) {
  avr_t *avr = chip->avr;
  avr_reset(avr);
  avr_regbit_set(avr, cause == CHIP_POWER_ON    ? avr->reset_flags.porf
                      : cause == CHIP_BROWN_OUT ? avr->reset_flags.borf
                                                : avr->reset_flags.extrf);
  finish_reset(chip);
}

void chip_brown_out(struct chip *chip, double lost) {
  scramble_memory(chip, lost);
  chip_reset(chip, CHIP_BROWN_OUT);
}

// Only a reset wakes a chip that sleeps with interrupts off or has crashed, and the watchdog may still cause
// one. So time passes without instructions.
static void skip_instructions(avr_t *avr) {
  avr_cycle_timer_slot_p next = avr->cycle_timers.timer;
  avr->cycle = next && next->when > avr->cycle ? next->when : avr->cycle + 1;
}

void chip_run(struct chip *chip, avr_cycle_count_t until) {
  avr_t *avr = chip->avr;
  chip->interrupted = false;
  chip_timer_start(&chip->run_end, until);
  bool crashed = avr->state == cpu_Crashed;
  while (avr->cycle < until && !chip->interrupted) {
    int state = avr_run(avr);
    if (chip->was_reset) {
      finish_reset(chip);
    } else if (state == cpu_Done || state == cpu_Crashed) {
      skip_instructions(avr);
      chip->crashes += state == cpu_Crashed && !crashed;
    }
    crashed = state == cpu_Crashed;
  }
}

void chip_interrupt(struct chip *chip) { chip->interrupted = true; }

avr_cycle_count_t chip_now(const struct chip *chip) { return chip->avr->cycle; }

avr_cycle_count_t chip_cycles(double seconds) { return (avr_cycle_count_t)(seconds * CHIP_FREQUENCY + 0.5); }

double chip_seconds(avr_cycle_count_t cycles) { return (double)cycles / CHIP_FREQUENCY; }

void chip_timer_add(struct chip *chip, struct chip_timer *timer, void (*fire)(void *owner), void *owner) {
  *timer = (struct chip_timer){.chip = chip, .fire = fire, .owner = owner, .next = chip->timers};
  chip->timers = timer;
}

void chip_timer_start(struct chip_timer *timer, avr_cycle_count_t when) {
  timer->when = when;
  timer->armed = true;
  register_timer(timer);
}

void chip_timer_stop(struct chip_timer *timer) {
  timer->armed = false;
  avr_cycle_timer_cancel(timer->chip->avr, on_timer, timer);
}

static void on_write(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  struct chip_write_hook *hook = param;
  hook->inner(avr, address, value, hook->inner_param);
  hook->after(hook->owner, value);
}

// libsimavr itself can share at most four registers.
void chip_hook_write(struct chip *chip, avr_io_addr_t address, struct chip_write_hook *hook,
                     void (*after)(void *owner, uint8_t value), void *owner) {
  avr_io_addr_t io = AVR_DATA_TO_IO(address);
  *hook = (struct chip_write_hook){.inner = chip->avr->io[io].w.c,
                                   .inner_param = chip->avr->io[io].w.param,
                                   .after = after,
                                   .owner = owner};
  chip->avr->io[io].w.c = on_write;
  chip->avr->io[io].w.param = hook;
}

void *chip_module(const struct chip *chip, const char *kind) {
  for (avr_io_t *io = chip->avr->io_port; io; io = io->next) {
    if (!strcmp(io->kind, kind)) {
      return io;
    }
  }
  return NULL;
}

avr_cycle_timer_slot_p chip_module_timer(const struct chip *chip, const void *module) {
  avr_cycle_timer_slot_p slot = chip->avr->cycle_timers.timer;
  while (slot && slot->param != module) {
    slot = slot->next;
  }
  return slot;
}
