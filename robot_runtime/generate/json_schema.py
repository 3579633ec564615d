"""JSON Schemas: of every packet and topic, and of the events that other programs are sent."""

import json
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from robot_runtime.contract.hints import Form, Hint, read_fields
from robot_runtime.contract.packets import DEFINITIONS_HASH, PACKETS
from robot_runtime.contract.packets.layout import Record, Wire
from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.topics import TOPICS

PLAIN_TYPES: Mapping[Form, str] = {"text": "string", "whole number": "integer", "nothing": "null"}


def schema() -> str:
    """Return the whole text of packets.schema.json."""
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
    """Return the whole text of published_events.schema.json."""
    hints = read_fields(PublishedEvent)
    document = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "µ-CAT events",
        "description": PublishedEvent.__doc__,
        "type": "object",
        "properties": {
            field.name: _plain(hints[field.name])
            | ({"description": field.metadata["meaning"]} if field.metadata else {})
            for field in fields(PublishedEvent)
        },
        "required": [*hints],
        "additionalProperties": False,
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def _plain(hint: Hint) -> dict[str, Any]:
    if hint.form == "choice":
        return {"enum": [*hint.choices]}
    types = [PLAIN_TYPES[part.form] for part in hint.parts or (hint,)]
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
    number: dict[str, Any] = {"type": "integer" if wire.integral else "number"}
    if wire.count > 1:
        number = {"type": "array", "items": number, "minItems": wire.count, "maxItems": wire.count}
    if wire.meaning:
        number["description"] = wire.meaning
    if wire.unit:
        number["unit"] = wire.unit
    return number
