"""The robot's topics for Foxglove and Lichtblick: the channels and schemas of an MCAP export, live.

A layout therefore fits both. Our own topics are in our own axes, and so are `/tf` and `/pose`: the frame
`ned` is below `world`, whose z points up.
"""

import json
from collections.abc import Mapping
from math import isfinite
from typing import Any

from robot_runtime.contract.chunks import MICRO, describe_topics
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import (
    BALANCED,
    CONTROL,
    MASK,
    OBSERVER,
    PARAMETERS,
    PICTURE,
    TOPICS,
    Kind,
)
from server.features.doors.channels import HEALTH, DoorChannel, Fields, Sample, convert_poses
from server.features.doors.ros_channels import DIAGNOSTICS, LINES, diagnostics
from server.interchange.foxglove_messages import (
    body_transform,
    compressed_image,
    log_line,
    pose_in_frame,
    world_transform,
)
from server.interchange.mcap_schemas import WELL_KNOWN, topic_schema
from server.interchange.plain_schema import without_null
from server.interchange.pose_tracker import POSE_TOPICS

CLOCK, CHANGED = "clock", "changed parameters"
"""Hidden channels: the moments at which the time is sent, and changes of parameters."""
PICTURES = {
    PICTURE.name: "/camera",
    OBSERVER.name: "/observer",
    MASK.name: "/mask",
    BALANCED.name: "/balanced",
}
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
    """Return all channels of the Foxglove door; a real robot has no true motion."""
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
        if topic.kind in (Kind.ROWS, Kind.DOCUMENTS) and (simulated or topic.sender != "simulator")
    ]
    pictures = [
        DoorChannel(name, "foxglove.CompressedImage", (topic,), _picture) for topic, name in PICTURES.items()
    ]
    return [
        *own,
        *pictures,
        DoorChannel("/log", "foxglove.Log", LINES, _log, lossless=True),
        DoorChannel("/tf", "foxglove.FrameTransform", POSE_TOPICS, convert_poses(body_transform)),
        DoorChannel("/tf_static", "foxglove.FrameTransform", (HEALTH,), _level, latched=True),
        DoorChannel("/pose", "foxglove.PoseInFrame", POSE_TOPICS, convert_poses(pose_in_frame)),
        DoorChannel("/diagnostics", DIAGNOSTICS, (HEALTH,), diagnostics, latched=True),
        DoorChannel(CLOCK, "", (CONTROL.name, HEALTH), _tick, hidden=True),
        DoorChannel(CHANGED, "", (PARAMETERS.name,), _tick, hidden=True),
    ]


def schema_text(channel: DoorChannel) -> str:
    """Return the JSON Schema of a channel's messages."""
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
    """Return no samples: the channel only triggers an update."""
    return {}


def _picture(sample: Sample) -> Fields:
    assert isinstance(sample.value, bytes)
    return compressed_image(sample.time, sample.value)


def _log(sample: Sample) -> Fields:
    assert isinstance(sample.value, Mapping)
    return log_line(sample.time, sample.source, sample.value)


def _level(sample: Sample) -> Fields:
    return world_transform(sample.time)
