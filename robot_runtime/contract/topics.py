"""The topics between the processes, and the block in which a batch of samples travels unchanged.

    block := topic u8 | kind u8 | count u16 | first u32 | bytes u32 | payload        (little-endian)

The runtime writes a block once; Zenoh, the server, the recorder and the page's socket pass on the same
bytes. `first` numbers the topic's first sample in the block, counting since its writer started, so that a
gap shows. The payload of a `rows` topic is `count` rows of equal size: the sample's time (f64, s, steady
clock), then the record's bytes as in `robot_runtime.contract.packets.layout`. Of a `documents` topic it is a
JSON array of `count` objects. Of a `picture` topic it is the time and one JPEG file.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import IntEnum
from struct import Struct
from typing import Self

from robot_runtime.contract import documents, packets
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.packets.layout import LayoutError, Record

HEADER = Struct("<BBHII")
TIME = Struct("<d")
NUMBERS = 1 << 32
"""Samples are numbered modulo this."""


class Kind(IntEnum):
    """The kind of payload that a block holds."""

    ROWS = 0
    DOCUMENTS = 1
    PICTURE = 2


@dataclass(frozen=True, slots=True)
class Topic:
    """One stream of samples; `record` is the class of its rows or documents."""

    id: int
    name: str
    kind: Kind
    record: type[Record] | type[documents.Document] | None
    meaning: str

    @property
    def row_bytes(self) -> int:
        """Bytes of one row with its time. Raises TypeError where the topic has no rows."""
        if self.record is None or not issubclass(self.record, Record):
            raise TypeError(f"topic {self.name} has no rows")
        return TIME.size + self.record.layout.size


TOPICS: tuple[Topic, ...] = (
    Topic(1, "imu", Kind.ROWS, packets.Imu, "attitude, turn rate and specific force"),
    Topic(2, "depth", Kind.ROWS, packets.Depth, "depth and pressure"),
    Topic(3, "beacon", Kind.ROWS, packets.Beacon, "light-beacon detectors"),
    Topic(4, "motor", Kind.ROWS, packets.Motor, "fins: wanted, measured, driven"),
    Topic(5, "status", Kind.ROWS, packets.Status, "the board's state and health"),
    Topic(6, "navigation", Kind.ROWS, packets.Navigation, "navigation commands sent to the board"),
    Topic(7, "control", Kind.ROWS, documents.Control, "ticks of the control node"),
    Topic(8, "link", Kind.ROWS, LinkStatistics, "the serial line"),
    Topic(9, "truth", Kind.ROWS, documents.Truth, "the simulated body"),
    Topic(10, "turning", Kind.ROWS, documents.Turning, "the same ticks, for heading, pitch and roll"),
    Topic(16, "state", Kind.DOCUMENTS, documents.State, "the robot as a whole"),
    Topic(17, "detection", Kind.DOCUMENTS, documents.Detection, "what the vision node found"),
    Topic(18, "debug", Kind.DOCUMENTS, documents.DebugLine, "lines of text from the firmware"),
    Topic(19, "event", Kind.DOCUMENTS, documents.Event, "what happened, told by the runtime"),
    Topic(20, "notice", Kind.DOCUMENTS, documents.Event, "what happened, told by the server"),
    Topic(21, "parameters", Kind.DOCUMENTS, documents.Parameters, "everything that may be tuned"),
    Topic(22, "experiment", Kind.DOCUMENTS, documents.Experiment, "how an experiment on a loop goes"),
    Topic(23, "vision", Kind.DOCUMENTS, documents.VisionInForce, "how the vision node looks"),
    Topic(32, "picture", Kind.PICTURE, None, "the camera's picture as the vision node saw it"),
    Topic(33, "observer", Kind.PICTURE, None, "the simulated scene as a bystander sees it"),
    Topic(34, "thumbnail", Kind.PICTURE, None, "a small picture of the camera's, for recordings"),
    Topic(35, "mask", Kind.PICTURE, None, "what of the picture has the wanted colour, and what of it counts"),
    Topic(36, "balanced", Kind.PICTURE, None, "the camera's picture after the white balance"),
)
BY_NAME = {topic.name: topic for topic in TOPICS}
RECORDED = tuple(topic for topic in TOPICS if topic.kind is not Kind.PICTURE or topic.name == "thumbnail")
"""The topics of a recording: all but the large pictures, which only a viewer is sent."""
BY_ID = {topic.id: topic for topic in TOPICS}
ROW_BYTES = {topic.id: topic.row_bytes for topic in TOPICS if topic.kind is Kind.ROWS}
"""Of one row with its time, by the topic's number."""


@dataclass(frozen=True, slots=True)
class Block:
    """A batch: `count` samples of one topic, numbered from `first` on; `data` is the block as it travels.

    `run` names the run of the process that sent it, "" if that is not known.
    """

    topic: Topic
    count: int
    first: int
    data: bytes
    run: str = ""

    @classmethod
    def of(cls, topic: Topic, count: int, first: int, payload: bytes, run: str = "") -> Self:
        """The block around a payload."""
        header = HEADER.pack(topic.id, topic.kind, count, first % NUMBERS, len(payload))
        return cls(topic, count, first, header + payload, run)

    @property
    def payload(self) -> bytes:
        """The block without its header."""
        return self.data[HEADER.size :]

    @property
    def following(self) -> int:
        """The number of the sample that comes after this block."""
        return (self.first + self.count) % NUMBERS

    def after(self, number: int) -> bool:
        """True if it holds the sample of this number or a later one, modulo 2^32."""
        return is_after(self.first, self.count, number)

    def time_of(self, number: int) -> float:
        """When the sample of this number was taken (s, steady clock).

        Raises IndexError where it is not in this block, LayoutError where the block is damaged.
        """
        place = (number - self.first) % NUMBERS
        if place >= self.count:
            raise IndexError(f"{number} is not one of {self.count} samples from {self.first} on")
        if self.topic.kind is not Kind.DOCUMENTS:
            size = ROW_BYTES.get(self.topic.id, 0)
            time: float = TIME.unpack_from(self.data, HEADER.size + place * size)[0]
            return time
        try:
            return float(json.loads(self.payload)[place]["time"])
        except (ValueError, LookupError, TypeError, RecursionError) as problem:
            raise LayoutError(f"a block of {self.topic.name} is damaged: {problem!r}") from problem


def is_after(first: int, count: int, number: int) -> bool:
    """True if the `count` samples from `first` on include this number or a later one, modulo 2^32."""
    return 0 < (first + count - number) % NUMBERS <= NUMBERS // 2


def row(time: float, record: bytes) -> bytes:
    """One row of a block: the sample's time, then the record's own bytes."""
    return TIME.pack(time) + record


def pack_documents(batch: Sequence[documents.Document]) -> bytes:
    """The payload of a block of documents. Raises ValueError on NaN or infinity, which JSON lacks."""
    return json.dumps(
        [asdict(document) for document in batch], allow_nan=False, separators=(",", ":")
    ).encode()


def read_blocks(data: bytes, run: str = "") -> list[Block]:
    """The blocks that `data` is, sent by `run`. Raises LayoutError where it is not blocks from end to end."""
    blocks: list[Block] = []
    at = 0
    while at < len(data):
        if len(data) - at < HEADER.size:
            raise LayoutError(f"a block's header is cut off after {len(data) - at} bytes")
        topic_id, kind, count, first, size = HEADER.unpack_from(data, at)
        topic = BY_ID.get(topic_id)
        if topic is None or topic.kind != kind:
            raise LayoutError(f"no topic {topic_id} of kind {kind}")
        end = at + HEADER.size + size
        if end > len(data):
            there = len(data) - at - HEADER.size
            raise LayoutError(f"a block of {topic.name} is cut off: {there} of {size} bytes")
        if count == 0 or (topic.kind is Kind.ROWS and size != count * ROW_BYTES[topic_id]):
            raise LayoutError(f"a block of {topic.name} holds {size} bytes, which are not {count} samples")
        blocks.append(Block(topic, count, first, data[at:end], run))
        at = end
    return blocks


def read_rows(block: Block) -> list[tuple[float, Record]]:
    """The times and records of a block of rows. Raises TypeError on a block of another kind."""
    size, record = block.topic.row_bytes, block.topic.record
    assert record is not None
    assert issubclass(record, Record)
    rows = (block.data[at : at + size] for at in range(HEADER.size, len(block.data), size))
    return [(TIME.unpack_from(one)[0], record.from_bytes(one[TIME.size :])) for one in rows]
