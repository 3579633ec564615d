"""The firmware's headers: packets and tunable parameters."""

from enum import IntEnum, IntFlag

from robot_runtime.contract.calibration import EMULATED, RECORD_ADDRESS, RECORD_VERSION, record
from robot_runtime.contract.packets import (
    CHIP_PARAMETERS,
    DEFINITIONS_HASH,
    ENUMERATIONS,
    FIN_COUNT,
    FRAME_BYTES_MAX,
    NOT_READY,
    PACKETS,
    Packet,
)
from robot_runtime.contract.packets.layout import C_TYPES, Wire

_HEAD = """\
// Written by `make generate` from robot_runtime/contract/packets/definitions.py. Do not edit.
#pragma once
#include <stdint.h>

#include "board/flash.h"

namespace mucat {

constexpr uint32_t kDefinitionsHash = 0x%08xUL;
constexpr uint8_t kFinCount = %d;
constexpr uint8_t kFrameBytesMax = %d;
constexpr uint8_t kNotReady = %d;
// Version of the calibration's record in EEPROM; it changes with the record's layout.
constexpr uint8_t kCalibrationVersion = %d;
"""

_CALIBRATION = """\
/* Written by `make generate` from robot_runtime/contract/calibration.py. Do not edit. */
/* The record in the EEPROM of a calibrated emulated board. */
#ifndef CALIBRATION_GEN_H
#define CALIBRATION_GEN_H

#define CALIBRATION_ADDRESS %d
#define CALIBRATION_BYTES %d

static const unsigned char calibration_record[CALIBRATION_BYTES] = {
%s};

#endif
"""

_PARAMETERS = """\
// Written by `make generate` from robot_runtime/contract/packets/chip_parameters.py. Do not edit.
#pragma once
#include <stdint.h>

#include "board/flash.h"

namespace mucat {

enum ParameterNumber : uint8_t {
%s};
constexpr uint8_t kParameterCount = %d;

// In thousandths of the unit.
struct ParameterLimits {
  uint16_t initial;
  uint16_t minimum;
  uint16_t maximum;
  bool while_armed;
};

const ParameterLimits kParameterLimits[kParameterCount] PROGMEM = {
%s};

}  // namespace mucat
"""


def parameters() -> str:
    """Return the whole text of parameters.gen.h."""
    numbers = "".join(
        f"  k{_camel(entry.name.replace('.', '_'))},  // {entry.meaning}; {entry.unit or 'a ratio'}\n"
        for entry in CHIP_PARAMETERS
    )
    rows = ""
    for entry in CHIP_PARAMETERS:
        limits = (round(value * 1000) for value in (entry.default, entry.minimum, entry.maximum))
        rows += f"    {{{', '.join(map(str, limits))}, {str(entry.while_armed).lower()}}},\n"
    return _PARAMETERS % (numbers, len(CHIP_PARAMETERS), rows)


def calibration() -> str:
    """Return the whole text of the emulator's calibration.gen.h."""
    stored = record(EMULATED.packet())
    rows = [stored[start : start + 12] for start in range(0, len(stored), 12)]
    text = "".join("    " + " ".join(f"0x{byte:02x}," for byte in row) + "\n" for row in rows)
    return _CALIBRATION % (RECORD_ADDRESS, len(stored), text)


def header() -> str:
    """Return the whole text of packets.gen.h."""
    head = _HEAD % (DEFINITIONS_HASH, FIN_COUNT, FRAME_BYTES_MAX, NOT_READY, RECORD_VERSION)
    enums = [_enum(enum) for enum in ENUMERATIONS]
    structs = [_struct(cls) for _, cls in sorted(PACKETS.items())]
    return "\n".join([head, *enums, *structs, _sizes(), _reliability(), "}  // namespace mucat", ""])


def _enum(enum: type[IntEnum] | type[IntFlag]) -> str:
    members = "".join(f"  k{_camel(member.name or '')} = {member.value},\n" for member in enum)
    size = 8 if max(enum) < 1 << 8 else 16 if max(enum) < 1 << 16 else 32
    return f"enum class {enum.__name__} : uint{size}_t {{\n{members}}};\n"


def _struct(cls: type[Packet]) -> str:
    described = [f"// {line.strip()}".rstrip() for line in (cls.__doc__ or "").strip().splitlines()]
    lines = [*described, f"struct __attribute__((packed)) {cls.__name__} {{"]
    lines.append(f"  static constexpr uint8_t kType = 0x{cls.type:02x};")
    lines += [_field(name, wire) for name, wire in cls.wires.items()]
    size = cls.layout.size
    if cls.tail:
        name, text = cls.tail
        lines += [f"  uint8_t {name}_size;", f"  char {name}[{text.max_bytes}];"]
        lines.append(f"  static constexpr uint8_t k{_camel(name)}Max = {text.max_bytes};")
        size += 1 + text.max_bytes
    lines.append("};")
    # C++ gives an empty struct a size of one.
    lines.append(
        f'static_assert(sizeof({cls.__name__}) == {max(size, 1)}, "{cls.__name__} has another size");'
    )
    return "\n".join([*lines, ""])


def _field(name: str, wire: Wire) -> str:
    array = f"[{wire.count}]" if wire.count > 1 else ""
    scale = f"x {wire.scale:.9g} {wire.unit}".strip() if wire.scale != 1 else wire.unit
    note = "; ".join(part for part in (wire.meaning, scale) if part)
    return f"  {C_TYPES[wire.code]} {name}{array};" + (f"  // {note}" if note else "")


def _sizes() -> str:
    fixed = {type_: cls.layout.size for type_, cls in PACKETS.items() if cls.tail is None}
    sizes = ", ".join(str(fixed.get(type_, -1)) for type_ in range(max(fixed) + 1))
    return (
        "// Payload bytes by type, in flash: the compiler puts the table of a switch into RAM.\n"
        f"const int8_t kPayloadBytes[] PROGMEM = {{{sizes}}};\n\n"
        "// Payload bytes of a type of fixed length; -1 for an unknown one or one that carries text.\n"
        "inline int8_t payload_bytes(uint8_t type) {\n"
        "  if (type >= sizeof kPayloadBytes) return -1;\n"
        "  return static_cast<int8_t>(pgm_read_byte(&kPayloadBytes[type]));\n}\n"
    )


def _reliability() -> str:
    tests = " || ".join(
        f"type == {cls.__name__}::kType" for _, cls in sorted(PACKETS.items()) if cls.reliable
    )
    return (
        "// Whether a packet of this type is repeated until it is acknowledged.\n"
        f"constexpr bool is_reliable(uint8_t type) {{ return {tests}; }}\n"
    )


def _camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.lower().split("_"))
