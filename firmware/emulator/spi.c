// SPDX-License-Identifier: GPL-3.0-or-later
#include "spi.h"

#include "registers.h"

#define BYTE_BITS 8

static avr_cycle_count_t bit_cycles(const struct spi *spi) {
  static const uint8_t dividers[4] = {4, 16, 64, 128};
  const uint8_t *data = spi->chip->avr->data;
  bool doubled = data[REGISTER_SPSR] & 1;
  return dividers[data[REGISTER_SPCR] & 3] / (doubled ? 2u : 1u);
}

static void on_data_written(void *owner, uint8_t value) {
  (void)value;
  struct spi *spi = owner;
  avr_cycle_timer_slot_p slot = chip_module_timer(spi->chip, spi->module);
  if (slot) {
    avr_cycle_timer_register(spi->chip->avr, BYTE_BITS * bit_cycles(spi), slot->timer, slot->param);
  }
}

static void on_byte(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  struct spi *spi = param;
  uint8_t mode = spi->chip->avr->data[REGISTER_SPCR] & (SPCR_CPOL | SPCR_CPHA);
  uint8_t received = spi->exchange(spi->owner, (uint8_t)value, !mode);
  avr_raise_irq(spi->module->io.irq + SPI_IRQ_INPUT, received);
}

void spi_create(struct spi *spi, struct chip *chip,
                uint8_t (*exchange)(void *owner, uint8_t sent, bool mode_0), void *owner) {
  *spi = (struct spi){.chip = chip, .module = chip_module(chip, "spi"), .exchange = exchange, .owner = owner};
  chip_hook_write(chip, REGISTER_SPDR, &spi->data_written, on_data_written, spi);
  avr_irq_register_notify(spi->module->io.irq + SPI_IRQ_OUTPUT, on_byte, spi);
}
