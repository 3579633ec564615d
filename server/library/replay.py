"""Samples of a range of a session, in the format of the live socket.

A seek takes one answer: the range is preceded by the values in force at its start, and by the earlier samples
that the page's charts and lists show.
"""

import json
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from math import inf
from typing import Any

from sqlalchemy import bindparam
from sqlmodel import col, select

from robot_runtime.contract.chunks import (
    DOCUMENTS_ENCODING,
    PICTURES_ENCODING,
    ROWS_ENCODING,
    StoredChunk,
    decode_pictures,
    decode_rows,
    describe_topics,
    unpack,
)
from robot_runtime.contract.topics import BY_NAME, CHART_SECONDS, FILM, LINES, STATE, TIME, AnyTopic
from robot_runtime.transport.blocks import COUNT_MAX, Block
from server import VERSION
from server.library.content import Recording, read_some
from server.library.upgrade import NoCounterpartError, rewrite_document, rewrite_rows
from server.platform.errors import InvalidError
from server.platform.models import Chunk

RANGE_MAX = 120.0
"""s of one answer."""
ROUNDING = 1e-6
"""s; two times that lie `RANGE_MAX` apart may lie farther apart once each has been added to another."""
HISTORY_MAX = CHART_SECONDS
"""s before the start of which an answer holds samples for charts."""
BYTES_MAX = 16_000_000
"""Largest size of one answer; two minutes at the robot's full rate are 2 MB."""
BLOCKS_MAX = 50_000
LISTED_CHUNKS = 300

log = logging.getLogger(__name__)


@dataclass(slots=True)
class ReplayBlocks:
    """Blocks in order of the times of their first samples, and the number of samples left out.

    Left out are damaged ones, and those without a counterpart in this version's definitions. Thumbnails and
    snapshots come as the camera's pictures, the film not at all: pages play it by itself.
    """

    data: bytes
    left_out: int


_CHUNKS = (
    select(*(getattr(Chunk, field.name) for field in fields(StoredChunk)))
    .where(Chunk.session_id == bindparam("session"), Chunk.topic == bindparam("topic"))
    .where(col(Chunk.number).between(bindparam("first"), bindparam("last")))
    .order_by(col(Chunk.number))
)


@dataclass(frozen=True, slots=True)
class _Range:
    """Samples from `since` up to, but not at, `end`; with `newest` at least one before `start`, if any."""

    since: float
    start: float
    end: float
    newest: bool


def read_blocks_between(
    recording: Recording, start: float, end: float, history: float | None = None
) -> ReplayBlocks:
    """Return the samples of a session from `start` to before `end` (s, steady clock), at most `RANGE_MAX`.

    With a `history` (s), also what a page needs that begins at `start`: of every topic the newest sample
    before it, of what charts need at most so much time before it, of lines the last ones. Raise
    InvalidError, StoreError.
    """
    if end - start > RANGE_MAX + ROUNDING:
        raise InvalidError(f"One answer holds at most {RANGE_MAX:g} s; ask for the rest after it.")
    ranges = {name: _range(name, start, end, history) for name in recording.topics}
    described = describe_topics()
    left_out, size = 0, 0
    timed: list[tuple[float, Block]] = []
    for name, limits in ranges.items():
        chunks = _find(recording, name, limits)
        recorded, topic = recording.topics[name], BY_NAME.get(name)
        if topic is FILM:
            continue
        if topic is None or recorded["kind"] != topic.kind.name.lower():
            left_out += sum(chunk.count for chunk in chunks if start <= chunk.first_time < end)
            continue
        same = recording.row.version == VERSION and recorded == described[name]
        reader = _Reader(topic, None if same else recorded)
        for time, block in reader.read(chunks, limits):
            size += len(block.data)
            if size > BYTES_MAX or len(timed) >= BLOCKS_MAX:
                raise InvalidError(
                    f"One answer holds at most {BYTES_MAX / 1e6:g} MB in {BLOCKS_MAX} blocks; "
                    "ask for a shorter time."
                )
            timed.append((time, block))
        left_out += reader.left_out
    if history is not None and not any(block.topic is STATE and time < start for time, block in timed):
        timed += _first_state(recording)
    timed.sort(key=lambda item: item[0])
    return ReplayBlocks(b"".join(block.data for _, block in timed), left_out)


def _first_state(recording: Recording) -> list[tuple[float, Block]]:
    """Return the robot's state when the session began, for the time before its first sample."""
    try:
        state = rewrite_document(json.loads(recording.row.robot_state), STATE)
    except (ValueError, TypeError):
        return []
    payload = json.dumps([state], separators=(",", ":")).encode()
    return [(float(state["time"]), Block.of(STATE, 1, 0, payload))]


def _range(name: str, start: float, end: float, history: float | None) -> _Range:
    if history is None:
        return _Range(start, start, end, newest=False)
    charted = BY_NAME[name].charted if name in BY_NAME else 0.0
    since = -inf if name in LINES else start - min(history, charted)
    return _Range(since, start, end, newest=True)


def _find(recording: Recording, name: str, limits: _Range) -> Iterator[StoredChunk]:
    """Yield the chunks of a topic that may have samples of the range, in order."""
    since = limits.start if limits.since == -inf else limits.since
    with recording.read() as database:
        first, last = recording.numbers(database, name, since, limits.end)
    if limits.since == -inf:
        first = max(0, first - LISTED_CHUNKS)
    while first <= last:
        which = {"session": recording.row.id, "topic": name, "first": first, "last": last}
        with recording.read() as database:
            chunks = [StoredChunk(*row) for row in read_some(database.connection().execute(_CHUNKS, which))]
        if not chunks:
            return
        yield from chunks
        first = chunks[-1].number + 1


@dataclass(frozen=True, slots=True)
class _Samples:
    """The samples of one chunk: their count, the time of each, and the number and bytes of some in a row."""

    count: int
    time: Callable[[int], float]
    payload: Callable[[int, int], tuple[int, bytes]]
    most: int = COUNT_MAX
    """Samples in a block."""


def _rows(rows: bytes, size: int) -> _Samples:
    return _Samples(
        len(rows) // size,
        lambda index: float(TIME.unpack_from(rows, index * size)[0]),
        lambda first, last: (last - first, rows[first * size : last * size]),
    )


def _documents(lines: list[bytes], topic: AnyTopic | None) -> _Samples:
    """Return the documents as lines of JSON, rewritten to `topic` if one is given."""

    def payload(first: int, last: int) -> tuple[int, bytes]:
        some = lines[first:last] if topic is None else list(_rewrite_lines(lines[first:last], topic))
        return len(some), b"[" + b",".join(some) + b"]"

    return _Samples(len(lines), lambda index: float(json.loads(lines[index])["time"]), payload)


def _pictures(pictures: list[tuple[float, bytes]]) -> _Samples:
    def payload(first: int, last: int) -> tuple[int, bytes]:
        return last - first, b"".join(TIME.pack(time) + jpeg for time, jpeg in pictures[first:last])

    return _Samples(len(pictures), lambda index: pictures[index][0], payload, most=1)


class _Reader:
    """Reader of blocks from a topic's chunks; `recorded` describes a topic whose definition has changed."""

    def __init__(self, topic: AnyTopic, recorded: Mapping[str, Any] | None) -> None:
        self.left_out = 0
        self._topic = topic
        self._given_as = topic.stands_for or topic
        self._recorded = recorded

    def read(self, chunks: Iterable[StoredChunk], limits: _Range) -> Iterator[tuple[float, Block]]:
        """Yield the blocks, each with the time of its first sample."""
        earlier: tuple[StoredChunk, int] | None = None
        has_earlier = not limits.newest
        for chunk in chunks:
            if chunk.first_time >= limits.end:
                break
            if chunk.last_time < limits.since:
                earlier = (chunk, chunk.count)
                continue
            samples = self._open(chunk)
            if samples is None:
                continue
            first = _count_before(samples, chunk, limits.since)
            last = _count_before(samples, chunk, limits.end)
            if first > 0:
                earlier = (chunk, first)
            if first < last:
                has_earlier = has_earlier or samples.time(first) < limits.start
                yield from self._blocks(samples, chunk, first, last)
        if not has_earlier and earlier is not None:
            chunk, count = earlier
            samples = self._open(chunk)
            if samples is not None:
                yield from self._blocks(samples, chunk, count - 1, count)

    def _open(self, chunk: StoredChunk) -> _Samples | None:
        try:
            samples = self._decode(chunk)
            if samples.count != chunk.count:
                raise ValueError(f"it holds {samples.count} samples instead of {chunk.count}")
            return samples
        except (ValueError, KeyError) as problem:
            log.warning("a chunk of %s cannot be read: %s", self._topic.name, problem)
        self.left_out += chunk.count
        return None

    def _decode(self, chunk: StoredChunk) -> _Samples:
        recorded = self._recorded
        if chunk.encoding == ROWS_ENCODING:
            size = self._topic.row_bytes if recorded is None else int(recorded["row_bytes"])
            rows = decode_rows(chunk.data, size)
            if recorded is not None:
                rows = rewrite_rows(rows, recorded, self._topic)
            return _rows(rows, self._topic.row_bytes)
        if chunk.encoding == DOCUMENTS_ENCODING:
            return _documents(unpack(chunk.data).splitlines(), None if recorded is None else self._topic)
        if chunk.encoding == PICTURES_ENCODING:
            return _pictures(list(decode_pictures(chunk.data)))
        raise ValueError(f"its encoding is {chunk.encoding!r}")

    def _blocks(
        self, samples: _Samples, chunk: StoredChunk, first: int, last: int
    ) -> Iterator[tuple[float, Block]]:
        for start in range(first, last, samples.most):
            end = min(last, start + samples.most)
            count, payload = samples.payload(start, end)
            self.left_out += end - start - count
            if count:
                yield samples.time(start), Block.of(self._given_as, count, chunk.first + start, payload)


def _count_before(samples: _Samples, chunk: StoredChunk, time: float) -> int:
    """Return the number of the chunk's samples, from its first on, before `time`."""
    if chunk.last_time < time:
        return chunk.count
    if chunk.first_time >= time:
        return 0
    # Times of the samples may lie about those of their chunk.
    return next((index for index in range(chunk.count) if samples.time(index) >= time), chunk.count)


def _rewrite_lines(lines: list[bytes], topic: AnyTopic) -> Iterator[bytes]:
    for line in lines:
        try:
            document = rewrite_document(json.loads(line), topic)
        except NoCounterpartError:
            continue
        yield json.dumps(document, separators=(",", ":")).encode()
