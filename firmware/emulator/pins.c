// SPDX-License-Identifier: GPL-3.0-or-later
#include "pins.h"

#include <avr_adc.h>
#include <avr_ioport.h>
#include <math.h>

#define FULL_SCALE 5000  // mV; libsimavr's converter has no other reference here

struct pin {
  char port;
  uint8_t bit;
};

static const struct pin select_pins[FIN_COUNT] = {{'D', 7}, {'B', 0}, {'B', 1}, {'B', 2}};  // D7 to D10
static const struct pin beacon_right_pin = {'D', 4};
static const struct pin beacon_left_pin = {'D', 5};
static const struct pin leak_pin = {'D', 2};
static const struct pin led_pin = {'C', 1};          // A1
static const struct pin motor_power_pin = {'C', 3};  // A3
static const int battery_input = ADC_IRQ_ADC2;       // A2

static avr_irq_t *pin_irq(struct chip *chip, struct pin pin) {
  return avr_io_getirq(chip->avr, AVR_IOCTL_IOPORT_GETIRQ(pin.port), pin.bit);
}

static void on_select(avr_irq_t *irq, uint32_t level, void *encoder) {
  (void)irq;
  as5040_select(encoder, !level);
}

static void on_led(avr_irq_t *irq, uint32_t level, void *param) {
  (void)irq;
  struct pins *pins = param;
  pins->led = level;
}

static void on_motor_power(avr_irq_t *irq, uint32_t level, void *param) {
  (void)irq;
  struct pins *pins = param;
  devices_set_motor_power(pins->devices, level);
}

// Resistors hold the levels of pins that nothing drives: selects high, LED and motor power low, detectors at
// their value.
static void pull(struct pins *pins, char port, uint8_t mask, uint8_t levels) {
  avr_ioport_external_t external = {.name = port, .mask = mask, .value = levels};
  avr_ioctl(pins->chip->avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &external);
}

void pins_create(struct pins *pins, struct chip *chip, struct devices *devices) {
  *pins = (struct pins){.chip = chip, .devices = devices};
  pins->beacon_right = pin_irq(chip, beacon_right_pin);
  pins->beacon_left = pin_irq(chip, beacon_left_pin);
  pins->leak = pin_irq(chip, leak_pin);
  pins->battery = avr_io_getirq(chip->avr, AVR_IOCTL_ADC_GETIRQ, battery_input);
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    avr_irq_register_notify(pin_irq(chip, select_pins[i]), on_select, &devices->encoders[i]);
  }
  avr_irq_register_notify(pin_irq(chip, led_pin), on_led, pins);
  avr_irq_register_notify(pin_irq(chip, motor_power_pin), on_motor_power, pins);
}

void pins_reset(struct pins *pins) {
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    as5040_select(&pins->devices->encoders[i], false);
    pin_irq(pins->chip, select_pins[i])->flags |= IRQ_FLAG_INIT;
  }
  pins->led = false;
  devices_set_motor_power(pins->devices, false);
  // A reset clears the levels of the pins; without this flag an unchanged one would not be reported.
  pin_irq(pins->chip, led_pin)->flags |= IRQ_FLAG_INIT;
  pin_irq(pins->chip, motor_power_pin)->flags |= IRQ_FLAG_INIT;
  pins->beacon_right->flags |= IRQ_FLAG_INIT;
  pins->beacon_left->flags |= IRQ_FLAG_INIT;
  pins->leak->flags |= IRQ_FLAG_INIT;
  pull(pins, 'B', 0x07, 0x07);
  pull(pins, 'C', 1 << led_pin.bit | 1 << motor_power_pin.bit, 0);
  pins_update_inputs(pins);
}

void pins_update_inputs(struct pins *pins) {
  bool levels[2];
  devices_beacons(pins->devices, levels);
  uint8_t beacons = (uint8_t)(levels[0] << beacon_right_pin.bit | levels[1] << beacon_left_pin.bit);
  bool dry = !pins->devices->leak;
  uint8_t high = (uint8_t)(1 << select_pins[0].bit | dry << leak_pin.bit);
  uint8_t mask =
      1 << beacon_right_pin.bit | 1 << beacon_left_pin.bit | 1 << select_pins[0].bit | 1 << leak_pin.bit;
  pull(pins, 'D', mask, beacons | high);
  avr_raise_irq(pins->beacon_right, levels[0]);
  avr_raise_irq(pins->beacon_left, levels[1]);
  avr_raise_irq(pins->leak, dry);
  pins_update_battery(pins);
}

void pins_update_battery(struct pins *pins) {
  avr_raise_irq(pins->battery, (uint32_t)lround(FULL_SCALE * devices_battery(pins->devices)));
}
