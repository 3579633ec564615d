"""JSON Schema of every packet and topic, for programs that read exports or listen to the topics."""

import json
from typing import Any

from robot_runtime.contract.packets import DEFINITIONS_HASH, PACKETS
from robot_runtime.contract.packets.layout import Record, Wire
from robot_runtime.contract.topics import TOPICS


def schema() -> str:
    """The whole text of packets.schema.json."""
    definitions = {cls.__name__: _object(cls) for cls in PACKETS.values()}
    records = [topic.record for topic in TOPICS if topic.record is not None]
    definitions |= {cls.__name__: _object(cls) for cls in records if issubclass(cls, Record)}
    document = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "µ-CAT packets and records",
        "definitions_hash": f"{DEFINITIONS_HASH:08x}",
        "$defs": definitions,
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def _object(cls: type[Record]) -> dict[str, Any]:
    properties = {name: _number(wire) for name, wire in cls.wires.items()}
    if cls.tail:
        name, text = cls.tail
        properties[name] = {"type": "string", "maxLength": text.max_bytes}
    packet_type = getattr(cls, "type", None)
    head = {"description": cls.__doc__, "type": "object"}
    if packet_type is not None:
        head["packet_type"] = packet_type
    return head | {"properties": properties, "required": list(properties), "additionalProperties": False}


def _number(wire: Wire) -> dict[str, Any]:
    one: dict[str, Any] = {"type": "integer" if wire.integral else "number"}
    if wire.count > 1:
        one = {"type": "array", "items": one, "minItems": wire.count, "maxItems": wire.count}
    if wire.meaning:
        one["description"] = wire.meaning
    if wire.unit:
        one["unit"] = wire.unit
    return one
