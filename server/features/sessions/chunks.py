"""Encoding of samples in the database: one chunk holds consecutive samples of one topic.

"shuffle-zlib": rows of equal size (the sample's time, then its record, as `robot_runtime.contract.topics`
says), with all first bytes of the rows first, then all second bytes, and so on; then zlib. Slowly changing
numbers have nearly equal high bytes, which lie side by side that way.
"lines-zlib": a JSON object a line; then zlib.
"pictures": of each picture its size (u32, little-endian), its time (f64), and the JPEG file, of that size.
Each session stores the description of its fields (`describe_topics`), so that a recording stays readable
when the definitions change.
"""

import json
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from io import BytesIO
from math import isfinite
from struct import Struct
from typing import Any

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import RECORDED, TIME, AnyTopic, Kind

ROWS_ENCODING = "shuffle-zlib"
DOCUMENTS_ENCODING = "lines-zlib"
PICTURES_ENCODING = "pictures"
PICTURE_SIZE = Struct("<I")
LEVEL = 1
"""zlib's fastest: on a Raspberry Pi Zero the rest gains little and costs much."""
CHUNK_BYTES_MAX = 16_000_000
"""Largest size of one chunk, packed or unpacked; the recorder's are 4 MB at most."""

DIGITS = {"f": "%.9g", "d": "%.17g"}
"""Enough decimal digits to read back the same number."""
SCALED_DIGITS = "%.12g"


@dataclass(frozen=True, slots=True)
class RowLayout:
    """Conversion of a row to text: unpack, multiply by `scales` (1 for whole numbers), format by `line`."""

    row: Struct
    scales: tuple[float, ...]
    line: str
    names: tuple[str, ...]
    """Names of the columns, such as "position_2"."""
    columns: tuple[str, ...]
    """Names of the columns with units, such as "position_2 [m]"."""


def shuffle(rows: bytes, size: int) -> bytes:
    """All first bytes of the rows of `size` bytes, then all second bytes, and so on."""
    return b"".join(rows[place::size] for place in range(size))


def unshuffle(shuffled: bytes, size: int) -> bytes:
    """The inverse of `shuffle`. Raises ValueError where the bytes are not whole rows."""
    count, left = divmod(len(shuffled), size)
    if left:
        raise ValueError(f"{len(shuffled)} bytes are not whole rows of {size}")
    rows = bytearray(len(shuffled))
    for place in range(size):
        rows[place::size] = shuffled[place * count : (place + 1) * count]
    return bytes(rows)


def unpack(data: bytes, limit: int = CHUNK_BYTES_MAX) -> bytes:
    """The unpacked bytes of a chunk. Raises ValueError where they are more than `limit`, or zlib.error."""
    unpacker = zlib.decompressobj()
    unpacked = unpacker.decompress(data, limit + 1)
    if len(unpacked) > limit:
        raise ValueError(f"it unpacks to more than {limit} bytes")
    if not unpacker.eof or unpacker.unused_data:
        raise ValueError("it is cut off, or followed by other bytes")
    return unpacked


def encode(topic: AnyTopic, payloads: Sequence[bytes], count: int) -> tuple[str, bytes, float, float]:
    """The encoding of these payloads of a topic, their chunk, and its first and last sample's times.

    Raises ValueError, RecursionError or zlib.error for payloads that do not fit the topic.
    """
    if topic.kind is Kind.ROWS:
        return ROWS_ENCODING, *encode_rows(payloads, topic.row_bytes)
    if topic.kind is Kind.PICTURE:
        return PICTURES_ENCODING, *encode_pictures(payloads)
    return DOCUMENTS_ENCODING, *encode_documents(payloads, count)


def encode_rows(payloads: Sequence[bytes], size: int) -> tuple[bytes, float, float]:
    """The chunk of these rows, and the times of the first and the last of them.

    Raises ValueError for times that are not finite.
    """
    rows = b"".join(payloads)
    first, last = TIME.unpack_from(rows)[0], TIME.unpack_from(rows, len(rows) - size)[0]
    if not (isfinite(first) and isfinite(last)):
        raise ValueError(f"rows from {first} s to {last} s")
    return zlib.compress(shuffle(rows, size), LEVEL), first, last


def decode_rows(data: bytes, size: int) -> bytes:
    """The rows of a chunk. Raises ValueError or zlib.error where it is damaged."""
    return unshuffle(unpack(data), size)


def encode_documents(payloads: Sequence[bytes], count: int) -> tuple[bytes, float, float]:
    """The chunk of these JSON arrays of together `count` objects, and the times of the first and the last.

    Raises ValueError for anything else.
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
    """The objects of a chunk. Raises ValueError or zlib.error where it is damaged."""
    for line in BytesIO(unpack(data)):
        yield json.loads(line)


def encode_pictures(payloads: Sequence[bytes]) -> tuple[bytes, float, float]:
    """The chunk of these pictures, each with its time first, and the times of the first and the last.

    Raises ValueError for a picture without a time.
    """
    if any(len(payload) <= TIME.size for payload in payloads):
        raise ValueError("a picture without a time or without bytes")
    first, last = TIME.unpack_from(payloads[0])[0], TIME.unpack_from(payloads[-1])[0]
    if not (isfinite(first) and isfinite(last)):
        raise ValueError(f"pictures from {first} s to {last} s")
    return b"".join(PICTURE_SIZE.pack(len(one) - TIME.size) + one for one in payloads), first, last


def decode_pictures(data: bytes) -> Iterator[tuple[float, bytes]]:
    """The time (s) and the JPEG file of each picture of a chunk. Raises ValueError where it is damaged."""
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
    """A description of the recorded topics, for a reader that has only the database."""
    return {topic.name: _describe(topic) for topic in RECORDED}


def row_layout(topic: dict[str, Any]) -> RowLayout:
    """The layout of a topic of rows, from its entry in what `describe_topics` wrote."""
    codes = "<d"
    scales: list[float] = []
    formats: list[str] = []
    names: list[str] = []
    columns: list[str] = []
    for field in topic["fields"]:
        code, count, scale = field["code"], field["count"], field["scale"]
        unit = f" [{field['unit']}]" if field["unit"] else ""
        codes += code * count
        scales += [scale] * count
        formats += [DIGITS.get(code, "%d" if scale == 1 else SCALED_DIGITS)] * count
        own = [*row_names(field)]
        names += own
        columns += [one + unit for one in own]
    return RowLayout(Struct(codes), tuple(scales), ",".join(formats), tuple(names), tuple(columns))


def row_names(field: dict[str, Any]) -> Iterator[str]:
    """Names of the columns of a field of rows, such as "position_2"."""
    name, count = field["name"], field["count"]
    if count == 1:
        yield name
    else:
        yield from (f"{name}_{place}" for place in range(count))


def _describe(topic: AnyTopic) -> dict[str, Any]:
    described: dict[str, Any] = {"meaning": topic.meaning, "kind": topic.kind.name.lower()}
    if topic.kind is Kind.PICTURE:
        described["fields"] = []
    elif issubclass(topic.record, Record):
        described["row_bytes"] = topic.row_bytes
        described["fields"] = [
            {
                "name": name,
                "code": wire.code,
                "count": wire.count,
                "scale": wire.scale,
                "unit": wire.unit,
                "meaning": wire.meaning,
            }
            for name, wire in topic.record.wires.items()
        ]
    else:
        described["fields"] = [{"name": field.name} for field in fields(topic.record)]
    return described
