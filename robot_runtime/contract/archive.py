"""The format of an archive: a session without loss, for µ-CAT on another machine.

A zip file whose members are stored as they are: `session.json`; for each topic `chunks/<topic>`, its chunks
one after the other as stored in the database, each after its HEAD; and last `checksums.json`, the SHA-256 of
every other member. Times stay on the session's own steady clock.
"""

from collections.abc import Iterator
from math import isfinite
from struct import Struct
from typing import IO

from robot_runtime.contract.chunks import CHUNK_BYTES_MAX, StoredChunk

FORMAT = "mucat-session"
VERSION = 1
HEAD = Struct("<IddqII16s")
"""Number, first and last time (s), number of the first sample, samples, bytes, encoding (padded with 0)."""
SESSION, CHECKSUMS, CHUNKS = "session.json", "checksums.json", "chunks/"


def pack_chunk(chunk: StoredChunk) -> bytes:
    """Return a chunk after its head."""
    head = HEAD.pack(
        chunk.number,
        chunk.first_time,
        chunk.last_time,
        chunk.first,
        chunk.count,
        len(chunk.data),
        chunk.encoding.encode(),
    )
    return head + chunk.data


def read_chunks(file: IO[bytes]) -> Iterator[StoredChunk]:
    """Yield the chunks of a member, with plausible heads; their data is not checked. Raise ValueError."""
    before = -1
    while head := file.read(HEAD.size):
        if len(head) < HEAD.size:
            raise ValueError(f"they are cut off after number {before}")
        number, first_time, last_time, first, count, size, encoding = HEAD.unpack(head)
        if size > CHUNK_BYTES_MAX or count == 0:
            raise ValueError(f"number {number} announces {count} samples in {size} bytes")
        if number <= before:
            raise ValueError(f"number {number} comes after number {before}")
        if not (isfinite(first_time) and isfinite(last_time)) or first < 0:
            raise ValueError(f"number {number} has an invalid time or number of a sample")
        before = number
        data = file.read(size)
        if len(data) < size:
            raise ValueError(f"number {number} is cut off")
        name = encoding.rstrip(b"\0").decode("ascii", "replace")
        yield StoredChunk(number, first_time, last_time, first, count, name, data)
