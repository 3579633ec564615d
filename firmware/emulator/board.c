// SPDX-License-Identifier: GPL-3.0-or-later
#include "board.h"

static void after_reset(void *owner) {
  struct board *board = owner;
  uart_reset(&board->uart);
  twi_reset(&board->twi);
  pins_reset(&board->pins);
}

static uint8_t exchange(void *owner, uint8_t sent, bool mode_0) {
  (void)sent;  // an encoder has no input
  struct board *board = owner;
  return devices_exchange_spi(&board->devices, mode_0);
}

static double chip_time(const void *chip) { return chip_seconds(chip_now(chip)); }

static void on_motors_due(void *owner) {
  struct board *board = owner;
  chip_timer_start(&board->motors_due, board->motors_due.when + chip_cycles(MOTORS_PERIOD));
  motors_step(&board->devices.motors);
  pins_update_battery(&board->pins);
}

bool board_create(struct board *board, struct pty *pty) {
  *board = (struct board){.pty = pty};
  if (!chip_create(&board->chip, after_reset, board)) {
    return false;
  }
  uart_create(&board->uart, &board->chip, &board->host.to_host);
  host_port_create(&board->host, &board->chip, pty, &board->uart.to_board);
  twi_create(&board->twi, &board->chip);
  spi_create(&board->spi, &board->chip, exchange, board);
  eeprom_create(&board->eeprom, &board->chip);
  devices_create(&board->devices, (struct device_clock){chip_time, &board->chip});
  pins_create(&board->pins, &board->chip, &board->devices);
  chip_timer_add(&board->chip, &board->motors_due, on_motors_due, board);
  chip_timer_start(&board->motors_due, chip_now(&board->chip) + chip_cycles(MOTORS_PERIOD));
  for (unsigned i = 0; i < I2C_DEVICES; i++) {
    twi_attach(&board->twi, &board->devices.i2c[i]);
  }
  return true;
}

bool board_power_cycle(struct board *board) {
  struct board before = *board;
  if (!board_create(board, before.pty)) {
    return false;
  }
  chip_copy_flash(&board->chip, &before.chip);
  eeprom_copy(&board->eeprom, &before.eeprom);
  chip_remove(&before.chip);
  board_set_wiring(board, &before.devices.wiring);
  board_set_surroundings(board, &before.devices.surroundings);
  return true;
}

void board_set_surroundings(struct board *board, const struct surroundings *surroundings) {
  devices_set_surroundings(&board->devices, surroundings);
  pins_update_inputs(&board->pins);
}

void board_set_wiring(struct board *board, const struct wiring *wiring) {
  devices_set_wiring(&board->devices, wiring);
  pins_update_inputs(&board->pins);
}
