// SPDX-License-Identifier: GPL-3.0-or-later
#include "board.h"

#include <stdio.h>
#include <string.h>

#define IMU_ADDRESS 0x69
#define PRESSURE_ADDRESS 0x76
static const uint8_t bridge_addresses[FIN_COUNT] = {0x64, 0x60, 0x61, 0x63};

static void after_reset(void *owner) {
  struct board *board = owner;
  uart_reset(&board->uart);
  twi_reset(&board->twi);
  pins_reset(&board->pins, &board->surroundings);
}

// The line from the encoders is pulled up where none of them is selected.
static uint8_t exchange(void *owner, uint8_t sent) {
  (void)sent;  // an encoder has no input
  struct board *board = owner;
  uint8_t received = 0xff;
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    if (board->encoders[i].selected) {
      received &= as5040_exchange(&board->encoders[i]);
    }
  }
  return received;
}

static void attach_devices(struct board *board) {
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    twi_attach(&board->twi, (struct twi_device){bridge_addresses[i], &board->bridges[i], drv8830_start,
                                                drv8830_write, drv8830_read});
  }
  twi_attach(&board->twi,
             (struct twi_device){IMU_ADDRESS, &board->imu, mpu6050_start, mpu6050_write, mpu6050_read});
  twi_attach(&board->twi, (struct twi_device){PRESSURE_ADDRESS, &board->pressure, ms5837_start, ms5837_write,
                                              ms5837_read});
}

bool board_create(struct board *board, struct pty *pty) {
  *board = (struct board){.surroundings = STILL_WATER, .pty = pty};
  if (!chip_create(&board->chip, after_reset, board)) {
    return false;
  }
  uart_create(&board->uart, &board->chip, &board->host.to_host);
  host_port_create(&board->host, &board->chip, pty, &board->uart.to_board);
  twi_create(&board->twi, &board->chip);
  spi_create(&board->spi, &board->chip, exchange, board);
  eeprom_create(&board->eeprom, &board->chip);
  mpu6050_create(&board->imu, &board->surroundings);
  ms5837_create(&board->pressure, &board->chip, &board->surroundings);
  pins_create(&board->pins, &board->chip, board->encoders, board->bridges);
  motors_create(&board->motors, &board->chip, board->bridges, board->encoders);
  attach_devices(board);
  return true;
}

bool board_renew(struct board *board) {
  struct board before = *board;
  if (!board_create(board, before.pty)) {
    return false;
  }
  chip_inherit(&board->chip, &before.chip);
  eeprom_inherit(&board->eeprom, &before.eeprom);
  chip_remove(&before.chip);
  board_feel(board, &before.surroundings);
  return true;
}

void board_feel(struct board *board, const struct surroundings *surroundings) {
  board->surroundings = *surroundings;
  pins_show(&board->pins, surroundings);
}

enum fault *board_fault(struct board *board, const char *device) {
  if (!strcmp(device, "imu")) {
    return &board->imu.fault;
  }
  if (!strcmp(device, "pressure")) {
    return &board->pressure.fault;
  }
  for (unsigned i = 0; i < FIN_COUNT; i++) {
    char encoder[] = "encoder0", bridge[] = "bridge0";
    encoder[sizeof encoder - 2] = bridge[sizeof bridge - 2] = (char)('0' + i);
    if (!strcmp(device, encoder)) {
      return &board->encoders[i].fault;
    }
    if (!strcmp(device, bridge)) {
      return &board->bridges[i].fault;
    }
  }
  return NULL;
}
