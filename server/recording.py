"""Reads what a session recorded: chunk by chunk, so that it is never in memory as a whole."""

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import inf
from typing import TYPE_CHECKING, Any

from sqlmodel import col, func, select

from server.chunks import (
    DOCUMENTS_ENCODING,
    PICTURES_ENCODING,
    ROWS_ENCODING,
    decode_documents,
    decode_pictures,
    decode_rows,
    row_layout,
)
from server.models import Chunk, SessionRow
from server.store import Reader

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

CHUNKS_AT_ONCE = 32


class RecordingError(Exception):
    """A recording that cannot be read; the text says what is wrong."""


class Recording:
    """One session's samples. What is committed while they are read may or may not be among them.

    Times are the session's own steady ones (s); `row.started_steady` is its start. Every reading method
    raises StoreError, and RecordingError where a chunk cannot be read.
    """

    def __init__(self, store: Reader, row: SessionRow) -> None:
        self.row = row
        self.topics: Mapping[str, dict[str, Any]] = json.loads(row.topics)
        """What `chunks.describe_topics` said when it was recorded, by name."""
        self._store = store

    def counts(self, start: float = -inf, end: float = inf) -> dict[str, int]:
        """Samples by topic, of the chunks that may have some between `start` and `end`; no topics without."""
        query = select(Chunk.topic, func.sum(Chunk.count)).where(Chunk.session_id == self.row.id)
        if start > -inf:
            query = query.where(Chunk.last_time >= start)
        if end < inf:
            query = query.where(Chunk.first_time <= end)
        with self._store.read() as database:
            return {name: int(count) for name, count in database.exec(query.group_by(Chunk.topic))}

    def spans(self, topic: str) -> list[tuple[float, float, int]]:
        """Of each chunk in order: the times of its first and its last sample, and how many it has."""
        query = (
            select(Chunk.first_time, Chunk.last_time, Chunk.count)
            .where(Chunk.session_id == self.row.id, Chunk.topic == topic)
            .order_by(col(Chunk.number))
        )
        with self._store.read() as database:
            return [(first, last, count) for first, last, count in database.exec(query)]

    def chunks(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[Chunk]:
        """The chunks that may have samples between `start` and `end`, in order."""
        number = -1
        while True:
            query = (
                select(Chunk)
                .where(Chunk.session_id == self.row.id, Chunk.topic == topic, Chunk.number > number)
                .order_by(col(Chunk.number))
                .limit(CHUNKS_AT_ONCE)
            )
            if start > -inf:
                query = query.where(Chunk.last_time >= start)
            if end < inf:
                query = query.where(Chunk.first_time <= end)
            with self._store.read() as database:
                found = database.exec(query).all()
            yield from found
            if len(found) < CHUNKS_AT_ONCE:
                return
            number = found[-1].number

    def rows(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[bytes]:
        """The rows of each such chunk, as `robot_runtime.topics` has them; not cut to the range."""
        size = self.topics[topic]["row_bytes"]
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, ROWS_ENCODING):
                rows = decode_rows(chunk.data, size)
            yield rows

    def documents(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[dict[str, Any]]:
        """The documents between `start` and `end`."""
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, DOCUMENTS_ENCODING):
                documents = list(decode_documents(chunk.data))
            yield from (one for one in documents if start <= one["time"] <= end)

    def pictures(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[tuple[float, bytes]]:
        """The pictures between `start` and `end`: their times and their JPEG files."""
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, PICTURES_ENCODING):
                pictures = list(decode_pictures(chunk.data))
            yield from (one for one in pictures if start <= one[0] <= end)

    def columns(
        self, topic: str, names: Sequence[str], start: float = -inf, end: float = inf
    ) -> "tuple[Floats, dict[str, Floats]]":
        """The times of a topic of rows (s, steady clock), and columns by their names, in their units.

        Names are without units, such as "depth" or "position_2"; arrays have the shape (samples,). Raises
        KeyError on a name that is not there.
        """
        import numpy as np  # only where somebody compares or exports: it costs a small computer memory

        layout = row_layout(self.topics[topic])
        plain = [column.partition(" [")[0] for column in layout.columns]
        for name in names:
            if name not in plain:
                raise KeyError(f"{topic} has no column {name}; it has {', '.join(plain)}")
        codes = "".join(field["code"] * field["count"] for field in self.topics[topic]["fields"])
        # Struct's codes mean the same to NumPy. Several topics have a column of their own named time.
        columns = [(f"column {name}", "<" + code) for name, code in zip(plain, codes, strict=True)]
        row = np.dtype([("time", "<f8"), *columns])
        pieces = [np.frombuffer(rows, row) for rows in self.rows(topic, start, end)]
        whole = np.concatenate(pieces) if pieces else np.empty(0, row)
        whole = whole[(whole["time"] >= start) & (whole["time"] <= end)]
        scales = dict(zip(plain, layout.scales, strict=True))
        values = {name: whole[f"column {name}"].astype(np.float64) * scales[name] for name in names}
        return whole["time"].astype(np.float64), values


@contextmanager
def _reading(chunk: Chunk, topic: str, encoding: str) -> Iterator[None]:
    if chunk.encoding != encoding:
        raise RecordingError(f"chunk {chunk.number} of {topic} is encoded as {chunk.encoding!r}")
    try:
        yield
    except (ValueError, KeyError, zlib.error) as problem:
        raise RecordingError(f"chunk {chunk.number} of {topic} is damaged: {problem}") from problem
