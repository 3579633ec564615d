// SPDX-License-Identifier: GPL-3.0-or-later
// Addresses of the ATmega328P's registers in data memory, and some of their bits.
#ifndef REGISTERS_H
#define REGISTERS_H

#define REGISTER_DDRC 0x27
#define PIN_SCL 0x20
#define REGISTER_EECR 0x3f
#define EECR_EEPE 0x02
#define REGISTER_SPCR 0x4c
#define SPCR_CPHA 0x04
#define SPCR_CPOL 0x08
#define REGISTER_SPSR 0x4d
#define REGISTER_SPDR 0x4e
#define REGISTER_TWBR 0xb8
#define REGISTER_TWSR 0xb9
#define REGISTER_TWCR 0xbc
#define TWCR_TWINT 0x80
#define REGISTER_UCSR0A 0xc0
#define REGISTER_UCSR0B 0xc1
#define UCSR0B_RXEN 0x10
#define REGISTER_UBRR0L 0xc4
#define REGISTER_UDR0 0xc6

#endif
