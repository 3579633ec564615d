"""Encoding of samples in the database: one chunk holds consecutive samples of one topic.

"shuffle-zlib": rows of equal size (the sample's time, then its record, as `robot_runtime.contract.topics`
says), with all first bytes of the rows first, then all second bytes, and so on; then zlib. Slowly changing
numbers have nearly equal high bytes, which lie side by side that way.
"lines-zlib": a JSON object a line; then zlib.
"pictures": of each picture its size (u32, little-endian), its time (f64), and the JPEG file, of that size.
"film": the same of pictures that build on those before them (`robot_runtime.contract.topics.FilmPicture`).
Where a version stores anything else, the encoding has another name: earlier versions then refuse it in words.
Each session stores the description of its fields (`describe_topics`), so that a recording stays readable
when the definitions change.
"""

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from io import BytesIO
from math import isfinite
from struct import Struct
from typing import Any

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import RECORDED, TIME, AnyTopic, Kind

ROWS_ENCODING = "shuffle-zlib"
DOCUMENTS_ENCODING = "lines-zlib"
PICTURES_ENCODING = "pictures"
FILM_ENCODING = "film"
ENCODINGS = {
    "rows": ROWS_ENCODING,
    "documents": DOCUMENTS_ENCODING,
    "picture": PICTURES_ENCODING,
    "film": FILM_ENCODING,
}
"""By the kinds of topics, as descriptions name them."""
PICTURE_SIZE = Struct("<I")
LEVEL = 1
"""zlib's fastest: on a Raspberry Pi Zero the rest gains little and costs much."""
CHUNK_BYTES_MAX = 16_000_000
"""Largest size of one chunk, packed or unpacked; the recorder's are 4 MB at most."""

DIGITS = {"f": "%.9g", "d": "%.17g"}
"""Enough decimal digits to read back the same number."""
SCALED_DIGITS = "%.12g"
MICRO = 1e-6


class UnknownEncodingError(ValueError):
    """A chunk is stored in a form that this version does not know"""


@dataclass(frozen=True, slots=True)
class StoredChunk:
    """A chunk of a topic as it is stored: its number, times (s, steady clock), samples from `first` on."""

    number: int
    first_time: float
    last_time: float
    first: int
    count: int
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class RowField:
    """One field of a topic of rows: `count` numbers of struct's type `code`, each times `scale` in `unit`."""

    name: str
    code: str
    count: int
    scale: float
    unit: str
    meaning: str

    @property
    def digits(self) -> str:
        """The format of a number, from which the same number is read back."""
        return DIGITS.get(self.code, "%d" if self.scale == 1 else SCALED_DIGITS)

    @property
    def columns(self) -> list[str]:
        """A name for each number, such as "position_2"."""
        return [self.name] if self.count == 1 else [f"{self.name}_{number}" for number in range(self.count)]


@dataclass(frozen=True, slots=True)
class RowLayout:
    """Conversion of a row to text: unpack, multiply by `scales` (1 for whole numbers), format by `line`."""

    row: Struct
    scales: tuple[float, ...]
    line: str
    names: tuple[str, ...]
    """Yield the names of the columns, such as "position_2"."""
    units: tuple[str, ...]
    """Empty where a column has none."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Yield the names of the columns with units, such as "position_2 [m]"."""
        named = zip(self.names, self.units, strict=True)
        return tuple(f"{name} [{unit}]" if unit else name for name, unit in named)


def shuffle(rows: bytes, size: int) -> bytes:
    """Return all first bytes of the rows of `size` bytes, then all second bytes, and so on."""
    return b"".join(rows[index::size] for index in range(size))


def unshuffle(shuffled: bytes, size: int) -> bytes:
    """Return the inverse of `shuffle`."""
    count = len(shuffled) // size
    rows = bytearray(len(shuffled))
    for index in range(size):
        rows[index::size] = shuffled[index * count : (index + 1) * count]
    return bytes(rows)


def join_shuffled(parts: Sequence[bytes], size: int) -> bytes:
    """Return the shuffled rows of all parts, each of which holds shuffled rows of `size` bytes."""
    counts = [len(part) // size for part in parts]
    return b"".join(
        part[index * count : (index + 1) * count]
        for index in range(size)
        for part, count in zip(parts, counts, strict=True)
    )


def shuffled_times(shuffled: bytes, size: int) -> tuple[float, ...]:
    """Return the times, s, of shuffled rows of `size` bytes, each of which begins with its time."""
    count = len(shuffled) // size
    return Struct(f"<{count}d").unpack(unshuffle(shuffled[: count * TIME.size], TIME.size))


def unpack(data: bytes, limit: int = CHUNK_BYTES_MAX) -> bytes:
    """Return the unpacked bytes of a chunk. Raise ValueError where it is damaged or larger than `limit`."""
    unpacker = zlib.decompressobj()
    try:
        unpacked = unpacker.decompress(data, limit + 1)
    except zlib.error as problem:
        raise ValueError(str(problem)) from problem
    if len(unpacked) > limit:
        raise ValueError(f"it unpacks to more than {limit} bytes")
    if not unpacker.eof or unpacker.unused_data:
        raise ValueError("it is cut off, or followed by other bytes")
    return unpacked


def require_encoding(encoding: str, kind: str) -> None:
    """Raise UnknownEncodingError where chunks of this kind of topic are encoded otherwise."""
    if encoding != ENCODINGS[kind]:
        raise UnknownEncodingError(f"it is encoded as {encoding!r}, which this version cannot read")


def encode(topic: AnyTopic, payloads: Sequence[bytes], count: int) -> tuple[str, bytes, float, float]:
    """Return the encoding of these payloads of a topic, their chunk, and its first and last sample's times.

    Raise ValueError or RecursionError for payloads that do not fit the topic.
    """
    if topic.kind is Kind.ROWS:
        return ROWS_ENCODING, *encode_rows(payloads, topic.row_bytes)
    if topic.kind is Kind.PICTURE:
        return PICTURES_ENCODING, *encode_pictures(payloads)
    if topic.kind is Kind.FILM:
        return FILM_ENCODING, *encode_pictures(payloads)
    return DOCUMENTS_ENCODING, *encode_documents(payloads, count)


def encode_rows(payloads: Sequence[bytes], size: int) -> tuple[bytes, float, float]:
    """Return the chunk of these rows, and the times of the first and the last of them.

    Raise ValueError for times that are not finite.
    """
    rows = b"".join(payloads)
    first, last = TIME.unpack_from(rows)[0], TIME.unpack_from(rows, len(rows) - size)[0]
    if not (isfinite(first) and isfinite(last)):
        raise ValueError(f"rows from {first} s to {last} s")
    return zlib.compress(shuffle(rows, size), LEVEL), first, last


def unpack_rows(data: bytes, size: int, limit: int = CHUNK_BYTES_MAX) -> bytes:
    """Return the rows of `size` bytes of a chunk, as `shuffle` left them. Raise ValueError as `unpack`."""
    shuffled = unpack(data, limit)
    if len(shuffled) % size:
        raise ValueError(f"{len(shuffled)} bytes are not whole rows of {size}")
    return shuffled


def decode_rows(data: bytes, size: int, limit: int = CHUNK_BYTES_MAX) -> bytes:
    """Return the rows of `size` bytes of a chunk. Raise ValueError as `unpack`."""
    return unshuffle(unpack_rows(data, size, limit), size)


def encode_documents(payloads: Sequence[bytes], count: int) -> tuple[bytes, float, float]:
    """Return the chunk of these JSON arrays with `count` objects in all, and the first and the last time.

    Raise ValueError for anything else.
    """
    try:
        documents = [document for payload in payloads for document in json.loads(payload)]
        first, last = float(documents[0]["time"]), float(documents[-1]["time"])
    except (KeyError, TypeError, IndexError, OverflowError) as problem:
        raise ValueError("documents must be lists of JSON objects with a time") from problem
    if len(documents) != count:
        raise ValueError(f"{len(documents)} documents instead of {count}")
    lines = "".join(
        json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n" for document in documents
    )
    return zlib.compress(lines.encode(), LEVEL), first, last


def decode_documents(data: bytes) -> Iterator[dict[str, Any]]:
    """Yield the objects of a chunk. Raise ValueError where it is damaged."""
    for line in BytesIO(unpack(data)):
        yield json.loads(line)


def encode_pictures(payloads: Sequence[bytes]) -> tuple[bytes, float, float]:
    """Return the chunk of these pictures, each with its time first, and the times of the first and the last.

    Raise ValueError for a picture without a time.
    """
    if any(len(payload) <= TIME.size for payload in payloads):
        raise ValueError("a picture without a time or without bytes")
    first, last = TIME.unpack_from(payloads[0])[0], TIME.unpack_from(payloads[-1])[0]
    if not (isfinite(first) and isfinite(last)):
        raise ValueError(f"pictures from {first} s to {last} s")
    return (
        b"".join(PICTURE_SIZE.pack(len(payload) - TIME.size) + payload for payload in payloads),
        first,
        last,
    )


def decode_pictures(data: bytes) -> Iterator[tuple[float, bytes]]:
    """Yield the time (s) and the bytes of each picture of a chunk.

    Raise ValueError where it is damaged.
    """
    at = 0
    while at < len(data):
        start = at + PICTURE_SIZE.size + TIME.size
        if start > len(data):
            raise ValueError("a picture is cut off")
        (size,) = PICTURE_SIZE.unpack_from(data, at)
        (time,) = TIME.unpack_from(data, at + PICTURE_SIZE.size)
        at = start + size
        if at > len(data):
            raise ValueError("a picture is cut off")
        yield time, data[start:at]


def describe_topics() -> dict[str, Any]:
    """Return a description of the recorded topics, for a reader with only the database."""
    return {topic.name: describe_topic(topic) for topic in RECORDED}


def describe_topic(topic: AnyTopic) -> dict[str, Any]:
    """Return the description of a topic: its meaning, its kind and its fields, of rows also their bytes."""
    described: dict[str, Any] = {"meaning": topic.meaning, "kind": topic.kind.name.lower()}
    if topic.kind in (Kind.PICTURE, Kind.FILM):
        described["fields"] = []
    elif issubclass(topic.record, Record):
        described["row_bytes"] = topic.row_bytes
        described["fields"] = [
            asdict(RowField(name, wire.code, wire.count, wire.scale, wire.unit, wire.meaning))
            for name, wire in topic.record.wires.items()
        ]
    else:
        described["fields"] = [{"name": field.name} for field in fields(topic.record)]
    return described


def row_fields(topic: Mapping[str, Any]) -> list[RowField]:
    """Return the fields of a topic of rows, from its entry in what `describe_topics` wrote."""
    names = [member.name for member in fields(RowField)]
    return [RowField(**{name: field[name] for name in names}) for field in topic["fields"]]


def si_fields(topic: Mapping[str, Any]) -> list[RowField]:
    """Return the same in SI units, as other programs get them.

    µs become s, and a field named `time` becomes `board_time`, since `time` is the sample's.
    """
    return [
        replace(
            field,
            name="board_time" if field.name == "time" else field.name,
            unit="s",
            scale=MICRO * field.scale,
        )
        if field.unit == "µs"
        else field
        for field in row_fields(topic)
    ]


def row_layout(topic: Mapping[str, Any]) -> RowLayout:
    """Return the layout of a topic of rows, from its entry in what `describe_topics` wrote."""
    each = [field for field in row_fields(topic) for _ in range(field.count)]
    return RowLayout(
        row=Struct("<d" + "".join(field.code for field in each)),
        scales=tuple(field.scale for field in each),
        line=",".join(field.digits for field in each),
        names=tuple(name for field in row_fields(topic) for name in field.columns),
        units=tuple(field.unit for field in each),
    )
