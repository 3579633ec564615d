"""Reads what a session recorded: chunk by chunk, so that it is never in memory as a whole."""

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import inf
from typing import TYPE_CHECKING, Any

from sqlmodel import Session, col, desc, func, select

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
from server.store import Store

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

    def __init__(self, store: Store, row: SessionRow) -> None:
        self.row = row
        self.topics: Mapping[str, dict[str, Any]] = json.loads(row.topics)
        """What `chunks.describe_topics` said when it was recorded, by name."""
        self._store = store

    @contextmanager
    def read(self) -> Iterator[Session]:
        """The database, for a query of one's own; as `Store.read`."""
        with self._store.read() as database:
            yield database

    def counts(self) -> dict[str, int]:
        """Samples by topic; topics without any are left out."""
        query = select(Chunk.topic, func.sum(Chunk.count)).where(Chunk.session_id == self.row.id)
        with self._store.read() as database:
            return {name: int(count) for name, count in database.exec(query.group_by(Chunk.topic))}

    def chunks(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[Chunk]:
        """The chunks that may have samples between `start` and `end`, in order."""
        with self._store.read() as database:
            first, last = self.numbers(database, topic, start, end)
        while first <= last:
            query = (
                select(Chunk)
                .where(Chunk.session_id == self.row.id, Chunk.topic == topic)
                .where(col(Chunk.number).between(first, last))
                .order_by(col(Chunk.number))
                .limit(CHUNKS_AT_ONCE)
            )
            with self._store.read() as database:
                found = database.exec(query).all()
            yield from (chunk for chunk in found if chunk.last_time >= start and chunk.first_time <= end)
            if len(found) < CHUNKS_AT_ONCE:
                return
            first = found[-1].number + 1

    def numbers(self, database: Session, topic: str, start: float, end: float) -> tuple[int, int]:
        """The first and the last number of the chunks that may have samples between these times.

        Found by the index of times, however long the session is. One more at either end, since the times of
        samples may overlap a little where two chunks meet. The last is before the first where there are none.
        """
        newest = (
            select(Chunk.number)
            .where(Chunk.session_id == self.row.id, Chunk.topic == topic)
            .order_by(desc(col(Chunk.first_time)))
            .limit(1)
        )
        last = database.exec(newest.where(Chunk.first_time <= end)).first()
        if last is None:
            return 0, -1
        first = None if start == -inf else database.exec(newest.where(Chunk.first_time <= start)).first()
        return (0 if first is None else max(first - 1, 0)), last + 1

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
