"""Channels, to which a door's clients subscribe; each sample is converted and encoded once for all."""

import base64
import json
import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from math import isfinite
from typing import Any

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TIME, TOPICS, Kind
from robot_runtime.transport.blocks import Block, read_rows
from server.features.doors.cbor import encode_cbor
from server.features.doors.ros2_messages import ros2_types
from server.interchange.pose_tracker import Pose, PoseTracker

Value = Record | Mapping[str, Any] | bytes
"""A record of a topic of rows, a document, or a picture's JPEG file."""
Fields = dict[str, Any]
"""A message's fields, made of JSON's types and of bytes."""

HEALTH = "health"
"""The source of the parts' health, which is no topic."""
JPEG_START = TIME.size
_PICTURES = frozenset(topic.name for topic in TOPICS if topic.kind is Kind.PICTURE)


@dataclass(frozen=True, slots=True)
class Sample:
    """A value of a topic, its `source`; `time` in ns, UTC."""

    source: str
    time: int
    value: Value


Convert = Callable[[Sample], Fields | None]
"""Makes a channel's message of a sample; None: no message."""


@dataclass(frozen=True, slots=True)
class DoorChannel:
    """A stream of messages. `sources` are the topics from which it is made.

    `latched`: a new subscriber gets the newest message at once. `lossless`: no message is skipped, and a
    client that falls too far behind is disconnected. `hidden`: it is part of the protocol, and not listed.
    """

    name: str
    type: str
    sources: tuple[str, ...]
    convert: Convert
    latched: bool = False
    lossless: bool = False
    hidden: bool = False

    @property
    def of_pictures(self) -> bool:
        """True where the channel's messages hold a picture."""
        return any(source in _PICTURES for source in self.sources)


class ChannelMessage:
    """One message of a channel, at `time` (ns, UTC)."""

    def __init__(self, channel: DoorChannel, time: int, fields: Fields) -> None:
        self.channel = channel
        self.time = time
        self.fields = fields

    @cached_property
    def json(self) -> str:
        """The message as JSON, with bytes in base64, and null for NaN and infinity."""
        return encode_json(self.fields)

    @cached_property
    def publication(self) -> str:
        """The message as rosbridge publishes it."""
        return f'{{"op":"publish","topic":{json.dumps(self.channel.name)},"msg":{self.json}}}'

    @cached_property
    def cbor(self) -> bytes:
        """The message in CBOR, with bytes unchanged."""
        return encode_cbor({"op": "publish", "topic": self.channel.name, "msg": self.fields})

    @cached_property
    def cdr(self) -> bytes:
        """The message as ROS 2 serialises it."""
        return ros2_types().encode(self.channel.type, self.fields)


def convert_poses(message: Callable[[int, Pose], Fields]) -> Convert:
    """Return a channel's conversion to messages of a time and a pose, with a tracker of its own."""
    tracker = PoseTracker()

    def convert(sample: Sample) -> Fields | None:
        pose = tracker.see(sample.source, sample.time, partial(getattr, sample.value))
        return None if pose is None else message(sample.time, pose)

    return convert


def encode_json(value: object) -> str:
    """Return the JSON of a message, in ASCII, with bytes in base64, and null for NaN and infinity."""
    try:
        return json.dumps(value, default=_encode_bytes, allow_nan=False, separators=(",", ":"))
    except ValueError:
        return json.dumps(finite(value), default=_encode_bytes, allow_nan=False, separators=(",", ":"))


def finite(value: Any) -> Any:
    """Return the value with None for each NaN and infinity, which JSON lacks."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return value


def read_samples(block: Block) -> list[tuple[float, Value]]:
    """Return the times (s, steady clock) and samples of a block. Raise ValueError where it is damaged."""
    if block.topic.kind is Kind.ROWS:
        return [(time, record) for time, record in read_rows(block)]
    try:
        if block.topic.kind is Kind.PICTURE:
            payload = block.payload
            return [(TIME.unpack_from(payload)[0], payload[JPEG_START:])]
        return [(float(document["time"]), document) for document in json.loads(block.payload)]
    except (LookupError, TypeError, RecursionError, struct.error) as problem:
        raise ValueError(f"a block of {block.topic.name} is damaged: {problem!r}") from problem


def sources_of(channels: Iterable[DoorChannel]) -> frozenset[str]:
    """Return the topics from which these channels are made."""
    return frozenset(source for channel in channels for source in channel.sources)


def _encode_bytes(value: object) -> str:
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    raise TypeError(f"{type(value).__name__} is no JSON")
