"""JSON Schemas for MCAP files: of our own topics, and of the well-known ones of Foxglove's panels.

Foxglove and Lichtblick read only a part of JSON Schema: every property needs one type of number, integer,
boolean, string, array or object (with its properties), and nothing else.
"""

from dataclasses import fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.topics import BY_NAME
from server.features.exports.values import fields_of

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
TEXT: Schema = {"type": "string"}
WHOLE: Schema = {"type": "integer"}
PLAIN: dict[Any, Schema] = {float: NUMBER, int: WHOLE, str: TEXT, bool: {"type": "boolean"}}


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
}
"""Names, fields and required fields of docs.foxglove.dev/docs/visualization/message-schemas."""


def topic_schema(name: str, topic: dict[str, Any]) -> Schema:
    """The schema of a recorded topic, from its description by `describe_topics`.

    Descriptions of documents have no types, so the schema lists only the fields known to this version; the
    messages hold the others too.
    """
    members: dict[str, Schema] = {"time": {**NUMBER, "description": "s since the session's start"}}
    if topic["kind"] == "rows":
        for field in fields_of(topic):
            unit = f" [{field.unit}]" if field.unit else ""
            value: Schema = {"type": "array", "items": NUMBER} if field.count > 1 else NUMBER
            members[field.name] = {**value, "description": field.meaning + unit}
    else:
        there = {field["name"] for field in topic["fields"]} - {"time"}
        known = _members(BY_NAME[name].record) if name in BY_NAME else {}
        members |= {field: schema for field, schema in known.items() if field in there}
    return {
        "title": f"mucat.{name}",
        "description": topic["meaning"],
        "type": "object",
        "properties": members,
    }


def _members(record: Any) -> dict[str, Schema]:
    if not is_dataclass(record):
        return {}
    hints = get_type_hints(record)
    return {field.name: _of(hints[field.name]) for field in fields(record)}


def _of(hint: Any) -> Schema:
    if hint in PLAIN:
        return PLAIN[hint]
    origin = get_origin(hint)
    if origin in (Union, UnionType):
        return _of(next(one for one in get_args(hint) if one is not NoneType))
    if origin is list:
        return {"type": "array", "items": _of(get_args(hint)[0])}
    if origin is Literal:
        return TEXT
    return {"type": "object", "properties": _members(hint)}
