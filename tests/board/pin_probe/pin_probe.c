// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a program on a bare emulated ATmega328P, with nothing on its pins, and prints what it does with them:
//
//   direction PORT DDR        at the end, both in hexadecimal: which pins are outputs
//   pulled PORT MASK          inputs with the chip's own pull-up
//   edges PORT BIT COUNT      how often an output changed
//   high PORT BIT             an output that was high at any time
//   address ADDRESS           each I2C address that was called, in the order of the first calls
//   byte MASK_B MASK_D        for each of the first SPI bytes: the outputs of ports B and D that were low
//   converted CHANNEL         each channel that the converter read
//   sent COUNT, listens BIT   bytes on the serial line; whether its receiver is on
//
// usage: pin_probe ELF SECONDS
#include <avr_adc.h>
#include <avr_ioport.h>
#include <avr_spi.h>
#include <avr_twi.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOCK 16000000
#define PORTS 3
#define BYTES_MAX 24
#define UCSR0B 0xC1

struct pin {
  char port;
  unsigned bit, edges, high;
};

static avr_t *avr;
static struct pin pins[PORTS][8];
static unsigned sent, bytes;
static unsigned char called[128], converted[16];

static avr_ioport_state_t state_of(char port) {
  avr_ioport_state_t state = {0};
  avr_ioctl(avr, AVR_IOCTL_IOPORT_GETSTATE(port), &state);
  return state;
}

static void on_pin(avr_irq_t *irq, uint32_t level, void *param) {
  struct pin *pin = param;
  if (!(state_of(pin->port).ddr >> pin->bit & 1)) return;
  pin->edges += (level & 1) != (irq->value & 1);
  pin->high |= level & 1;
}

static void on_i2c(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)param;
  avr_twi_msg_irq_t message = {.u.v = value};
  unsigned address = message.u.twi.addr >> 1;
  if (!(message.u.twi.msg & TWI_COND_START) || called[address]) return;
  called[address] = 1;
  printf("address 0x%02x\n", address);
}

static void on_spi(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)value, (void)param;
  if (bytes++ >= BYTES_MAX) return;
  avr_ioport_state_t b = state_of('B'), d = state_of('D');
  printf("byte %02x %02x\n", b.ddr & ~b.port & 0xff, d.ddr & ~d.port & 0xff);
}

static void on_conversion(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)param;
  union {
    avr_adc_mux_t mux;
    uint32_t v;
  } e = {.v = value};
  if (converted[e.mux.src & 15]++) return;
  printf("converted %u\n", e.mux.src);
}

static void on_sent(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)value, (void)param;
  sent++;
}

static void log_nothing(avr_t *chip, const int level, const char *format, va_list arguments) {
  (void)chip, (void)level, (void)format, (void)arguments;
}

static void listen_to(avr_irq_t *irq, avr_irq_notify_t notify, void *param) {
  if (!irq) {
    fputs("this libsimavr lacks a part of the chip\n", stderr);
    exit(1);
  }
  avr_irq_register_notify(irq, notify, param);
}

int main(int count, char **arguments) {
  elf_firmware_t firmware = {0};
  avr_global_logger_set(log_nothing);
  avr = avr_make_mcu_by_name("atmega328p");
  if (count != 3 || !avr || avr_init(avr) || elf_read_firmware(arguments[1], &firmware)) {
    fputs("usage: pin_probe ELF SECONDS\n", stderr);
    return 2;
  }
  firmware.frequency = CLOCK;
  avr_load_firmware(avr, &firmware);
  avr->frequency = CLOCK;
  avr->vcc = avr->avcc = avr->aref = 5000;
  for (unsigned port = 0; port < PORTS; port++) {
    for (unsigned bit = 0; bit < 8; bit++) {
      pins[port][bit] = (struct pin){(char)('B' + port), bit, 0, 0};
      listen_to(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B' + port), bit), on_pin, &pins[port][bit]);
    }
  }
  uint32_t silent = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &silent);
  listen_to(avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_OUTPUT), on_i2c, NULL);
  listen_to(avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_OUTPUT), on_spi, NULL);
  listen_to(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER), on_conversion, NULL);
  listen_to(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_sent, NULL);
  avr_cycle_count_t end = (avr_cycle_count_t)(atof(arguments[2]) * CLOCK);
  while (avr->cycle < end) {
    int state = avr_run(avr);
    if (state == cpu_Done || state == cpu_Crashed) {
      fputs("the program ended\n", stderr);
      return 1;
    }
  }
  for (char port = 'B'; port < 'B' + PORTS; port++) {
    avr_ioport_state_t state = state_of(port);
    printf("direction %c %02x\n", port, (unsigned)state.ddr);
    printf("pulled %c %02x\n", port, state.port & ~state.ddr & 0xff);
    for (unsigned bit = 0; bit < 8; bit++) {
      const struct pin *pin = &pins[port - 'B'][bit];
      if (pin->edges) printf("edges %c %u %u\n", port, bit, pin->edges);
      if (pin->high) printf("high %c %u\n", port, bit);
    }
  }
  printf("sent %u\nlistens %u\n", sent, avr->data[UCSR0B] >> 4 & 1);
  return 0;
}
