"""JSON Schemas for MCAP files: of our own topics, and of the well-known ones of Foxglove's panels.

Foxglove and Lichtblick read only a part of JSON Schema: every property needs one type of number, integer,
boolean, string, array or object (with its properties), and nothing else. So a message has no member that is
null: a number that is NaN, or that nobody knows, is left out.
"""

from functools import cache
from typing import Any

from pydantic import TypeAdapter

from robot_runtime.contract.chunks import si_fields
from robot_runtime.contract.topics import BY_NAME
from server.interchange.plain_schema import simplify

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
TEXT: Schema = {"type": "string"}
DIALECT = "https://json-schema.org/draft/2020-12/schema"


def _object(title: str = "", **members: Schema) -> Schema:
    named = {"title": title} if title else {}
    return {**named, "type": "object", "properties": members, "required": list(members)}


NANOSECONDS_MAX = 999_999_999
_TIME: Schema = {
    "title": "time",
    "type": "object",
    "properties": {
        "sec": {"type": "integer", "minimum": 0},
        "nsec": {"type": "integer", "minimum": 0, "maximum": NANOSECONDS_MAX},
    },
}
_VECTOR = _object("foxglove.Vector3", x=NUMBER, y=NUMBER, z=NUMBER)
_QUATERNION = _object("foxglove.Quaternion", x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
_LEVEL: Schema = {
    "title": "foxglove.LogLevel",
    "oneOf": [
        {"title": title, "const": number}
        for number, title in enumerate(("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"))
    ],
}
WELL_KNOWN = {
    "foxglove.Log": _object(
        "foxglove.Log",
        timestamp=_TIME,
        level=_LEVEL,
        message=TEXT,
        name=TEXT,
        file=TEXT,
        line={"type": "integer", "minimum": 0},
    ),
    "foxglove.FrameTransform": _object(
        "foxglove.FrameTransform",
        timestamp=_TIME,
        parent_frame_id=TEXT,
        child_frame_id=TEXT,
        translation=_VECTOR,
        rotation=_QUATERNION,
    ),
    "foxglove.PoseInFrame": _object(
        "foxglove.PoseInFrame",
        timestamp=_TIME,
        frame_id=TEXT,
        pose=_object("foxglove.Pose", position=_VECTOR, orientation=_QUATERNION),
    ),
    "foxglove.CompressedImage": _object(
        "foxglove.CompressedImage",
        timestamp=_TIME,
        frame_id=TEXT,
        data={"type": "string", "contentEncoding": "base64"},
        format=TEXT,
    ),
    "foxglove.CompressedVideo": _object(
        "foxglove.CompressedVideo",
        timestamp=_TIME,
        frame_id=TEXT,
        data={"type": "string", "contentEncoding": "base64"},
        format=TEXT,
    ),
}
"""Names, fields and required fields of docs.foxglove.dev/docs/visualization/message-schemas."""


def topic_schema(name: str, topic: dict[str, Any]) -> Schema:
    """Return the schema of a recorded topic, from its description by `describe_topics`.

    Descriptions of documents have no types, so the schema lists only the fields known to this version; the
    messages hold the others too.
    """
    members: dict[str, Schema] = {"time": {**NUMBER, "description": "s since the session's start"}}
    if topic["kind"] == "rows":
        for field in si_fields(topic):
            unit = f" [{field.unit}]" if field.unit else ""
            value = _several(field.count) if field.count > 1 else NUMBER
            members[field.name] = {**value, "description": field.meaning + unit}
    else:
        there = {field["name"] for field in topic["fields"]} - {"time"}
        known = document_members(name)
        members |= {field: schema for field, schema in known.items() if field in there}
    return {
        "$schema": DIALECT,
        "title": f"mucat.{name}",
        "description": topic["meaning"],
        "type": "object",
        "properties": members,
    }


@cache
def document_members(name: str) -> dict[str, Schema]:
    """Return the schemas of a document's fields, by its class in the contract; none for an unknown topic."""
    record = BY_NAME[name].record if name in BY_NAME else None
    if record is None:
        return {}
    members: dict[str, Schema] = simplify(TypeAdapter(record).json_schema())["properties"]
    return members


def _several(count: int) -> Schema:
    """Return the schema of so many numbers, null for NaN: Foxglove reads only `items`, also beyond them."""
    return {"type": "array", "prefixItems": [{"type": ["number", "null"]}] * count, "items": NUMBER}
