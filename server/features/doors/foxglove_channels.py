"""The robot's topics for Foxglove and Lichtblick: the channels and schemas of an MCAP export, live.

A layout therefore fits both. Our own topics are in our own axes, and so are `/tf` and `/pose`: the frame
`ned` is below `world`, whose z points up.
"""

import json
from collections.abc import Mapping
from math import isfinite
from typing import Any

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TOPICS, Kind
from server.features.doors.channels import HEALTH, Convert, DoorChannel, Fields, Sample
from server.features.doors.pose_tracker import SOURCES, PoseTracker
from server.features.doors.ros_channels import DIAGNOSTICS, LINES, diagnostics
from server.features.exports.mcap_file import DEBUG_LEVEL_OFFSET, INFO, SEVERITIES
from server.features.exports.mcap_schemas import WELL_KNOWN, topic_schema
from server.features.exports.plain_schema import without_null
from server.features.exports.pose import BODY, LEVEL, WORLD, stamp
from server.features.exports.values import MICRO
from server.features.sessions.chunks import describe_topics

CLOCK, PARAMETERS = "clock", "changed parameters"
"""Hidden channels: the moments at which the time is sent, and changes of parameters."""
PICTURES = {"picture": "/camera", "observer": "/observer", "mask": "/mask", "balanced": "/balanced"}
_TEXT = {"type": "string"}
_WHOLE = {"type": "integer"}
_PAIR = {"type": "object", "properties": {"key": _TEXT, "value": _TEXT}}
_STATUS = {
    "type": "object",
    "properties": {
        "level": _WHOLE,
        "name": _TEXT,
        "message": _TEXT,
        "hardware_id": _TEXT,
        "values": {"type": "array", "items": _PAIR},
    },
}
_STAMP = {"type": "object", "properties": {"sec": _WHOLE, "nanosec": _WHOLE}}
DIAGNOSTICS_SCHEMA: dict[str, Any] = {
    "title": DIAGNOSTICS,
    "type": "object",
    "properties": {
        "header": {"type": "object", "properties": {"stamp": _STAMP, "frame_id": _TEXT}},
        "status": {"type": "array", "items": _STATUS},
    },
}


def foxglove_channels(simulated: bool) -> list[DoorChannel]:
    """All channels of the Foxglove door; a real robot has no true motion."""
    own = [
        DoorChannel(
            f"/{topic.name}",
            f"mucat.{topic.name}",
            (topic.name,),
            _rows if topic.kind is Kind.ROWS else _document,
            latched=topic.newest_only,
            lossless=topic.lines,
        )
        for topic in TOPICS
        if topic.kind is not Kind.PICTURE and (simulated or topic.sender != "simulator")
    ]
    pictures = [
        DoorChannel(name, "foxglove.CompressedImage", (one,), _picture) for one, name in PICTURES.items()
    ]
    return [
        *own,
        *pictures,
        DoorChannel("/log", "foxglove.Log", LINES, _log, lossless=True),
        DoorChannel("/tf", "foxglove.FrameTransform", SOURCES, _transforms()),
        DoorChannel("/tf_static", "foxglove.FrameTransform", (HEALTH,), _level, latched=True),
        DoorChannel("/pose", "foxglove.PoseInFrame", SOURCES, _poses()),
        DoorChannel("/diagnostics", DIAGNOSTICS, (HEALTH,), diagnostics, latched=True),
        DoorChannel(CLOCK, "", ("control", HEALTH), _tick, hidden=True),
        DoorChannel(PARAMETERS, "", ("parameters",), _tick, hidden=True),
    ]


def schema_text(channel: DoorChannel) -> str:
    """The JSON Schema of a channel's messages."""
    if channel.type == DIAGNOSTICS:
        return json.dumps(DIAGNOSTICS_SCHEMA)
    if channel.type in WELL_KNOWN:
        return json.dumps(WELL_KNOWN[channel.type])
    (name,) = channel.sources
    schema = topic_schema(name, describe_topics()[name])
    schema["properties"]["time"] = {"type": "number", "description": "s, the robot's steady clock"}
    return json.dumps(schema)


def _rows(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Record)
    fields: Fields = {}
    for name, wire in value.wires.items():
        field = getattr(value, name)
        if wire.unit == "µs":
            field = field * MICRO
        if wire.count > 1:
            fields[name] = list(field)
        elif isfinite(field):
            fields["board_time" if name == "time" else name] = field
    return fields


def _document(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Mapping)
    fields: Fields = without_null(value)
    return fields


def _tick(_: Sample) -> Fields:
    """Nothing: that it comes is enough."""
    return {}


def _picture(sample: Sample) -> Fields:
    return {"timestamp": stamp(sample.time), "frame_id": "camera", "data": sample.value, "format": "jpeg"}


def _log(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Mapping)
    if sample.source == "debug":
        level = int(value["level"]) + DEBUG_LEVEL_OFFSET
    else:
        level = SEVERITIES.get(str(value.get("severity", "")), INFO)
    return {
        "timestamp": stamp(sample.time),
        "level": level,
        "message": value["text"],
        "name": value.get("kind", sample.source),
        "file": sample.source,
        "line": 0,
    }


def _transforms() -> Convert:
    tracker = PoseTracker()

    def convert(sample: Sample) -> Fields | None:
        found = tracker.see(sample)
        return None if found is None else _transform(sample.time, LEVEL, BODY, *map(list, found))

    return convert


def _poses() -> Convert:
    tracker = PoseTracker()

    def convert(sample: Sample) -> Fields | None:
        found = tracker.see(sample)
        if found is None:
            return None
        position, turn = found
        pose = {
            "position": dict(zip("xyz", position, strict=True)),
            "orientation": dict(zip("wxyz", turn, strict=True)),
        }
        return {"timestamp": stamp(sample.time), "frame_id": LEVEL, "pose": pose}

    return convert


def _level(sample: Sample) -> Fields:
    return _transform(sample.time, WORLD, LEVEL, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0])


def _transform(time: int, parent: str, child: str, place: list[float], turn: list[float]) -> Fields:
    return {
        "timestamp": stamp(time),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": dict(zip("xyz", place, strict=True)),
        "rotation": dict(zip("wxyz", turn, strict=True)),
    }
