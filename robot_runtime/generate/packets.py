"""docs/reference/packets.md: every packet of the serial line."""

from enum import IntEnum, IntFlag

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    FRAME_BYTES_MAX,
    PACKETS,
    DebugLevel,
    ResetCause,
    SensorFault,
    StatusFlag,
)
from robot_runtime.contract.packets.definitions import Packet
from robot_runtime.contract.packets.layout import C_TYPES, Text, Wire
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/contract/packets/definitions.py"
ENUMERATIONS: tuple[type[IntEnum] | type[IntFlag], ...] = (DebugLevel, StatusFlag, SensorFault, ResetCause)
INTRODUCTION = f"""\
A message is the packet's type (one byte), then its fields, little-endian and without gaps. [The serial
link](link.md) says how messages travel in frames of at most {FRAME_BYTES_MAX} bytes. A *reliable* packet is
repeated until it is acknowledged. The definitions of this version have the hash `{DEFINITIONS_HASH:08x}`;
both ends compare it.
"""


def packets_page() -> str:
    """The whole text of packets.md."""
    parts = [INTRODUCTION, table(("type", "packet", "bytes", "reliable"), map(_summary, PACKETS.values()))]
    for packet in PACKETS.values():
        parts += [f"## {packet.__name__}\n", f"`0x{packet.type:02X}`. {_sentence(packet)}\n"]
        fields = [_number(name, wire) for name, wire in packet.wires.items()]
        fields += [_text(*packet.tail)] if packet.tail else []
        if fields:
            parts.append(table(("field", "on the wire", "one count is", "meaning"), fields))
    parts.append("## Flags and codes\n")
    for enumeration in ENUMERATIONS:
        rows = ((str(member.value), f"`{member.name}`") for member in enumeration)
        parts += [f"### {enumeration.__name__}\n", f"{enumeration.__doc__}\n", table(("value", "name"), rows)]
    return page("Packets", SOURCE, *parts)


def _summary(packet: type[Packet]) -> tuple[str, ...]:
    reliable = "yes" if packet.reliable else ""
    link = f"[{packet.__name__}](#{packet.__name__.lower()})"
    return f"`0x{packet.type:02X}`", link, packet.describe_size(), reliable


def _sentence(packet: type[Packet]) -> str:
    return " ".join((packet.__doc__ or "").split())


def _number(name: str, wire: Wire) -> tuple[str, ...]:
    type_ = C_TYPES[wire.code] + (f" × {wire.count}" if wire.count > 1 else "")
    step = f"{wire.scale:.6g} {wire.unit}".strip() if wire.scale != 1 or wire.unit else ""
    return f"`{name}`", f"`{type_}`", step, wire.meaning


def _text(name: str, text: Text) -> tuple[str, ...]:
    return f"`{name}`", f"`uint8_t` length, then at most {text.max_bytes} bytes of UTF-8", "", text.meaning
