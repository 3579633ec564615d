"""Blocks: batches of samples of one topic, which travel unchanged between the processes.

    block := topic u8 | kind u8 | count u16 | first u32 | bytes u32 | payload        (little-endian)

The runtime writes a block once; Zenoh, the server, the recorder and the page's socket pass on the same
bytes. `first` numbers the topic's first sample in the block, counting since its writer started, so that a
gap shows. The payload of a `rows` topic is `count` rows of equal size: the sample's time (f64, s, steady
clock), then the record's bytes as in `robot_runtime.contract.packets.layout`. Of a `documents` topic it is a
JSON array of `count` objects. Of a `picture` topic it is the time and one JPEG file.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from struct import Struct
from typing import Any, Self

from robot_runtime.contract import documents
from robot_runtime.contract.packets.layout import LayoutError, Record
from robot_runtime.contract.topics import BY_ID, ROW_BYTES, TIME, AnyTopic, Kind

HEADER = Struct("<BBHII")
NUMBERS = 1 << 32
"""Samples are numbered modulo this."""
COUNT_MAX = 65_535
"""Greatest number of samples in a block."""


@dataclass(slots=True)
class Block:
    """A batch: `count` samples of one topic, numbered from `first` on; `data` is the block as it travels.

    `run` names the run of the process that sent it, "" if that is not known. A block never changes. It is
    not frozen, because hundreds are made a second, and a frozen dataclass takes four times as long to make.
    """

    topic: AnyTopic
    count: int
    first: int
    data: bytes
    run: str = ""

    @classmethod
    def of(cls, topic: AnyTopic, count: int, first: int, payload: bytes, run: str = "") -> Self:
        """Return the block around a payload."""
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
        """Return True if it holds the sample of this number or a later one, modulo 2^32."""
        return is_after(self.first, self.count, number)

    def time_of(self, number: int) -> float:
        """Return the time of the sample with this number (s, steady clock).

        Raise IndexError where it is not in this block, LayoutError where the block is damaged.
        """
        index = (number - self.first) % NUMBERS
        if index >= self.count:
            raise IndexError(f"{number} is not one of {self.count} samples from {self.first} on")
        if self.topic.kind is not Kind.DOCUMENTS:
            size = ROW_BYTES.get(self.topic.id, 0)
            time: float = TIME.unpack_from(self.data, HEADER.size + index * size)[0]
            return time
        try:
            return float(json.loads(self.payload)[index]["time"])
        except (ValueError, LookupError, TypeError, RecursionError) as problem:
            raise LayoutError(f"a block of {self.topic.name} is damaged: {problem!r}") from problem


def is_after(first: int, count: int, number: int) -> bool:
    """Return True if the `count` samples from `first` on include this number or a later one, modulo 2^32."""
    return 0 < (first + count - number) % NUMBERS <= NUMBERS // 2


def row(time: float, record: bytes) -> bytes:
    """Return one row of a block: the sample's time, then the record's own bytes."""
    return TIME.pack(time) + record


def pack_documents(batch: Sequence[documents.Document]) -> bytes:
    """Return the payload of a block of documents. Raise ValueError on NaN or infinity, which JSON lacks."""
    return json.dumps(batch, default=_list_fields, allow_nan=False, separators=(",", ":")).encode()


def _list_fields(document: Any) -> dict[str, object]:
    """Return a dataclass's fields for JSON's encoder.

    `asdict` copies all values, which takes three times as long.
    """
    return {name: getattr(document, name) for name in _field_names(document.__class__)}


@cache
def _field_names(cls: type) -> tuple[str, ...]:
    return tuple(field.name for field in fields(cls))


def read_blocks(data: bytes, run: str = "") -> list[Block]:
    """Return the blocks in `data`, sent by `run`. Raise LayoutError unless it is blocks from end to end."""
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


def gather_payloads(data: bytes, gathered: Mapping[int, list[bytes]]) -> None:
    """Append the payloads of the blocks in `data` to the lists of their topics, by the topics' numbers.

    Blocks of other topics are passed over. Nothing is checked: `data` is this process's own. A minute of a
    robot has some 20,000 blocks, which `read_blocks` takes five times as long for.
    """
    at = 0
    while at < len(data):
        topic, _, _, _, size = HEADER.unpack_from(data, at)
        at += HEADER.size
        if topic in gathered:
            gathered[topic].append(data[at : at + size])
        at += size


def read_rows(block: Block) -> list[tuple[float, Record]]:
    """Return the times and records of a block of rows. Raise TypeError on a block of another kind."""
    size, record = block.topic.row_bytes, block.topic.record
    assert issubclass(record, Record)
    rows = (block.data[at : at + size] for at in range(HEADER.size, len(block.data), size))
    return [(TIME.unpack_from(row)[0], record.from_bytes(row[TIME.size :])) for row in rows]
