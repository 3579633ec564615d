// SPDX-License-Identifier: GPL-3.0-or-later
#include "twi.h"

#include <string.h>

#include "registers.h"

#define CHARACTER_BITS 9
#define START_BITS 1
#define CLOCKS_TO_RELEASE 9
#define STRETCH 200e-6  // s

// The TWSR codes of a master, as in the chip's data sheet.
enum status {
  START = 0x08,
  REPEATED_START = 0x10,
  ADDRESS_WRITE_ACK = 0x18,
  ADDRESS_WRITE_NACK = 0x20,
  DATA_WRITE_ACK = 0x28,
  DATA_WRITE_NACK = 0x30,
  ARBITRATION_LOST = 0x38,
};

static void answer(struct twi *twi, uint8_t condition, uint8_t data) {
  avr_raise_irq(twi->module->io.irq + TWI_IRQ_INPUT, avr_twi_irq_msg(condition, twi->address, data));
}

// True if any device acknowledges the address.
static bool select_devices(struct twi *twi, uint8_t address) {
  bool any = false;
  twi->address = address;
  twi->index = 0;
  for (unsigned i = 0; i < twi->device_count; i++) {
    const struct i2c_device *device = twi->devices[i];
    twi->selected[i] =
        twi->fault != TWI_FAULT_CONTESTED && device->address == address && device->start(device->device);
    any |= twi->selected[i];
  }
  return any;
}

static void deselect_devices(struct twi *twi) { memset(twi->selected, 0, sizeof twi->selected); }

static void write_devices(struct twi *twi, uint8_t byte) {
  bool any = false;
  for (unsigned i = 0; i < twi->device_count; i++) {
    if (twi->selected[i]) {
      twi->devices[i]->write(twi->devices[i]->device, twi->index, byte);
      any = true;
    }
  }
  twi->index++;
  if (any) {
    answer(twi, TWI_COND_ACK, 1);
  }
}

// On an open-drain line every device that sends a 0 wins.
static void read_devices(struct twi *twi) {
  uint8_t byte = 0xff;
  bool any = false;
  for (unsigned i = 0; i < twi->device_count; i++) {
    if (twi->selected[i]) {
      byte &= twi->devices[i]->read(twi->devices[i]->device);
      any = true;
    }
  }
  if (any) {
    answer(twi, TWI_COND_READ, byte);
  }
}

static void on_bus(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  struct twi *twi = param;
  avr_twi_msg_irq_t message = {.u.v = value};
  uint8_t condition = message.u.twi.msg;
  if (condition & TWI_COND_START) {
    twi->addressed = true;
    if (select_devices(twi, message.u.twi.addr >> 1)) {
      answer(twi, TWI_COND_ACK, 1);
    }
    return;
  }
  if (condition & TWI_COND_WRITE) {
    if (twi->fault == TWI_FAULT_REFUSED) {
      return;
    }
    write_devices(twi, message.u.twi.data);
  }
  if (condition & TWI_COND_READ) {
    read_devices(twi);
  }
  if (condition & TWI_COND_STOP) {
    deselect_devices(twi);
  }
}

static avr_cycle_count_t bit_cycles(const struct twi *twi) {
  const uint8_t *data = twi->chip->avr->data;
  return 16 + 2u * data[REGISTER_TWBR] * (1u << 2 * (data[REGISTER_TWSR] & 3));
}

static uint8_t corrected_status(struct twi *twi, uint8_t status) {
  bool address = twi->addressed;
  twi->addressed = false;
  if (twi->fault == TWI_FAULT_CONTESTED && status != START && status != REPEATED_START) {
    return ARBITRATION_LOST;
  }
  if (address && status == DATA_WRITE_ACK) {
    return ADDRESS_WRITE_ACK;
  }
  if (address && status == DATA_WRITE_NACK) {
    return ADDRESS_WRITE_NACK;
  }
  return status;
}

static void on_control_written(void *owner, uint8_t value) {
  struct twi *twi = owner;
  if (value & TWCR_TWINT) {
    // Writing a 1 clears the flag; libsimavr leaves it set for a program that polls.
    twi->chip->avr->data[REGISTER_TWCR] &= (uint8_t)~TWCR_TWINT;
  }
  avr_cycle_timer_slot_p slot = chip_module_timer(twi->chip, twi->module);
  if (!slot || slot->when == twi->timer_when) {
    return;
  }
  if (twi->fault == TWI_FAULT_STUCK) {
    twi->clocks = 0;
    avr_cycle_timer_cancel(twi->chip->avr, slot->timer, slot->param);
    return;
  }
  uint8_t status = corrected_status(twi, twi->module->next_twstate);
  twi->module->next_twstate = status;
  unsigned bits = status == START || status == REPEATED_START ? START_BITS : CHARACTER_BITS;
  avr_cycle_count_t delay = bits * bit_cycles(twi);
  if (twi->fault == TWI_FAULT_STRETCHED && bits == CHARACTER_BITS) {
    delay += chip_cycles(STRETCH);
  }
  twi->timer_when = chip_now(twi->chip) + delay;
  avr_cycle_timer_register(twi->chip->avr, delay, slot->timer, slot->param);
}

// The program clocks the bus by hand: resistors pull the pin up where it is an input.
static void on_direction_written(void *owner, uint8_t value) {
  struct twi *twi = owner;
  bool low = value & PIN_SCL;
  if (twi->clock_low && !low && twi->fault == TWI_FAULT_STUCK && ++twi->clocks == CLOCKS_TO_RELEASE) {
    twi->fault = TWI_FAULT_NONE;
  }
  twi->clock_low = low;
}

void twi_create(struct twi *twi, struct chip *chip) {
  *twi = (struct twi){.chip = chip, .module = chip_module(chip, "twi")};
  chip_hook_write(chip, REGISTER_TWCR, &twi->control_written, on_control_written, twi);
  chip_hook_write(chip, REGISTER_DDRC, &twi->direction_written, on_direction_written, twi);
  avr_irq_register_notify(twi->module->io.irq + TWI_IRQ_OUTPUT, on_bus, twi);
}

void twi_attach(struct twi *twi, const struct i2c_device *device) {
  if (twi->device_count < TWI_DEVICES_MAX) {
    twi->devices[twi->device_count++] = device;
  }
}

void twi_reset(struct twi *twi) {
  deselect_devices(twi);
  twi->addressed = false;
}

bool twi_set_fault(struct twi *twi, const char *fault) {
  static const char *const faults[] = {[TWI_FAULT_NONE] = "none",
                                       [TWI_FAULT_STUCK] = "stuck",
                                       [TWI_FAULT_REFUSED] = "refused",
                                       [TWI_FAULT_STRETCHED] = "stretched",
                                       [TWI_FAULT_CONTESTED] = "contested"};
  for (unsigned i = 0; i < sizeof faults / sizeof *faults; i++) {
    if (!strcmp(fault, faults[i])) {
      twi->fault = (enum twi_fault)i;
      twi->clocks = 0;
      return true;
    }
  }
  return false;
}
