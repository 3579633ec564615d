"""JSON Schemas: of every packet and topic, and of the events that other programs are sent."""

import json
from dataclasses import fields
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from robot_runtime.contract.packets import DEFINITIONS_HASH, PACKETS
from robot_runtime.contract.packets.layout import Record, Wire
from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.topics import TOPICS

PLAIN_TYPES = {str: "string", int: "integer", NoneType: "null"}


def schema() -> str:
    """The whole text of packets.schema.json."""
    definitions = {cls.__name__: _object(cls) for cls in PACKETS.values()}
    records = [topic.record for topic in TOPICS]
    definitions |= {cls.__name__: _object(cls) for cls in records if issubclass(cls, Record)}
    document = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "µ-CAT packets and records",
        "definitions_hash": f"{DEFINITIONS_HASH:08x}",
        "$defs": definitions,
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def event_schema() -> str:
    """The whole text of published_events.schema.json."""
    hints = get_type_hints(PublishedEvent)
    document = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "µ-CAT events",
        "description": PublishedEvent.__doc__,
        "type": "object",
        "properties": {
            one.name: _plain(hints[one.name])
            | ({"description": one.metadata["meaning"]} if one.metadata else {})
            for one in fields(PublishedEvent)
        },
        "required": [*hints],
        "additionalProperties": False,
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def _plain(hint: Any) -> dict[str, Any]:
    if get_origin(hint) is Literal:
        return {"enum": [*get_args(hint)]}
    types = [PLAIN_TYPES[one] for one in get_args(hint) or (hint,)]
    return {"type": types if len(types) > 1 else types[0]}


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
