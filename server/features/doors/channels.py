"""Channels: what a door's clients subscribe to; each sample is converted and encoded once for all of them."""

import base64
import json
import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TIME, TOPICS, Kind
from robot_runtime.transport.blocks import Block, read_rows
from server.features.doors.cbor import encode_cbor
from server.features.doors.png import encode_png
from server.features.doors.ros2_messages import ros2_types

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
    """A stream of messages. `sources` are the topics that it is made of.

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
        """True where its messages hold a picture."""
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
        """The same in CBOR, with bytes as they are."""
        return encode_cbor({"op": "publish", "topic": self.channel.name, "msg": self.fields})

    @cached_property
    def cdr(self) -> bytes:
        """The message as ROS 2 serialises it."""
        return ros2_types().encode(self.channel.type, self.fields)

    @cached_property
    def png(self) -> str:
        """The same as a picture, as rosbridge compresses it."""
        return encode_json({"op": "png", "data": encode_png(self.publication.encode())})


def encode_json(value: object) -> str:
    """The JSON of a message, in ASCII, with bytes in base64, and null for NaN and infinity."""
    try:
        return json.dumps(value, default=_encode_bytes, allow_nan=False, separators=(",", ":"))
    except ValueError:
        return json.dumps(finite(value), default=_encode_bytes, allow_nan=False, separators=(",", ":"))


def finite(value: Any) -> Any:
    """The value with None for each NaN and infinity, which JSON lacks."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return value


def read_samples(block: Block) -> list[tuple[float, Value]]:
    """The times (s, steady clock) and samples of a block. Raises ValueError where it is damaged."""
    if block.topic.kind is Kind.ROWS:
        return [(time, record) for time, record in read_rows(block)]
    try:
        if block.topic.kind is Kind.PICTURE:
            payload = block.payload
            return [(TIME.unpack_from(payload)[0], payload[JPEG_START:])]
        return [(float(one["time"]), one) for one in json.loads(block.payload)]
    except (LookupError, TypeError, RecursionError, struct.error) as problem:
        raise ValueError(f"a block of {block.topic.name} is damaged: {problem!r}") from problem


def sources_of(channels: Iterable[DoorChannel]) -> frozenset[str]:
    """The topics that these channels are made of."""
    return frozenset(source for channel in channels for source in channel.sources)


def _encode_bytes(value: object) -> str:
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    raise TypeError(f"{type(value).__name__} is no JSON")
