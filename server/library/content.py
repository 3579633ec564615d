"""Reading of a session's samples chunk by chunk, so that it is never in memory as a whole."""

import json
import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import groupby, islice
from math import inf
from typing import TYPE_CHECKING, Any

from sqlalchemy import bindparam
from sqlmodel import Session, col, desc, func, select

from robot_runtime.contract.chunks import (
    CHUNK_BYTES_MAX,
    UnknownEncodingError,
    decode_documents,
    decode_pictures,
    decode_rows,
    require_encoding,
    row_layout,
    unpack,
    unpack_rows,
)
from robot_runtime.contract.topics import FILM
from server.platform.errors import ApiError
from server.platform.models import Chunk, SessionRow
from server.platform.store import Reader
from server.recording.session import find_row

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

log = logging.getLogger(__name__)

CHUNKS_AT_ONCE = 32
DATA_AT_ONCE = 512
_NEWEST = (
    select(Chunk.number)
    .where(Chunk.session_id == bindparam("session"), Chunk.topic == bindparam("topic"))
    .where(Chunk.first_time <= bindparam("time"))
    .order_by(desc(col(Chunk.first_time)))
    .limit(1)
)
"""The newest chunk that begins at or before a time; made once, since that takes longer than to run it."""
_COLUMNS = select(*(getattr(Chunk, name) for name in Chunk.model_fields))
_DATA = select(Chunk.number, Chunk.encoding, Chunk.data)


class RecordingError(ApiError):
    """The recording cannot be read whole"""

    @property
    def detail(self) -> str:
        """The text of the answer: other sessions are not affected."""
        return f"This recording cannot be read whole: {self}. Other sessions are not affected."


class Recording:
    """One session's samples; those committed while it is read may be missing.

    Times are the session's own steady ones (s); `row.started_steady` is its start. Every reading method
    raises StoreError, and RecordingError where a chunk cannot be read.
    """

    def __init__(self, store: Reader, row: SessionRow) -> None:
        self.row = row
        self.topics: Mapping[str, dict[str, Any]] = json.loads(row.topics)
        """Descriptions by topic, as `chunks.describe_topics` wrote them at the recording."""
        self._store = store

    @classmethod
    def open(cls, store: Reader, session: int) -> "Recording":
        """Return the recording of a session, also from the bin. Raise UnknownSessionError, StoreError."""
        return cls(store, find_row(store, session))

    @contextmanager
    def read(self) -> Iterator[Session]:
        """Open the database for another query, as `Store.read`."""
        with self._store.read() as database:
            yield database

    def counts(self, start: float = -inf, end: float = inf) -> dict[str, int]:
        """Return the numbers of samples by topic in the chunks that may overlap this range, without zeros."""
        query = select(Chunk.topic, func.sum(Chunk.count)).where(Chunk.session_id == self.row.id)
        if start > -inf:
            query = query.where(Chunk.last_time >= start)
        if end < inf:
            query = query.where(Chunk.first_time <= end)
        with self._store.read() as database:
            return {name: int(count) for name, count in database.exec(query.group_by(Chunk.topic))}

    def has(self, topic: str) -> bool:
        """Return True where the session has any sample of the topic."""
        query = select(Chunk.id).where(Chunk.session_id == self.row.id, Chunk.topic == topic).limit(1)
        with self._store.read() as database:
            return database.exec(query).first() is not None

    def spans(self, topic: str) -> list[tuple[float, float, int]]:
        """Return first time, last time and number of samples of each chunk in order."""
        query = (
            select(Chunk.first_time, Chunk.last_time, Chunk.count)
            .where(Chunk.session_id == self.row.id, Chunk.topic == topic)
            .order_by(col(Chunk.number))
        )
        with self._store.read() as database:
            return [(first, last, count) for first, last, count in database.exec(query)]

    def chunks(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[Any]:
        """Return the columns of the chunks that may have samples between `start` and `end`, in order."""
        return self._select(_COLUMNS, CHUNKS_AT_ONCE, topic, start, end)

    def numbers(self, database: Session, topic: str, start: float, end: float) -> tuple[int, int]:
        """Return the first and the last number of the chunks that may have samples between these times.

        Found by the index of times, however long the session is. One more at either end, since the times of
        samples may overlap a little where two chunks meet. The last is before the first where there are none.
        """
        connection = database.connection()
        selection = {"session": self.row.id, "topic": topic}
        last: int | None = connection.execute(_NEWEST, {**selection, "time": end}).scalar()
        if last is None:
            return 0, -1
        first: int | None = connection.execute(_NEWEST, {**selection, "time": start}).scalar()
        return (0 if first is None else max(first - 1, 0)), last + 1

    def rows(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[bytes]:
        """Yield the rows of each such chunk, in the layout of the topic; not cut to the range."""
        size = self.topics[topic]["row_bytes"]
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, "rows"):
                rows = decode_rows(chunk.data, size)
            yield rows

    def documents(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[dict[str, Any]]:
        """Yield the documents between `start` and `end`."""
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, "documents"):
                yield from (
                    document for document in decode_documents(chunk.data) if start <= document["time"] <= end
                )

    def pictures(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[tuple[float, bytes]]:
        """Yield the pictures between `start` and `end`: their times and their JPEG files."""
        for chunk in self.chunks(topic, start, end):
            with _reading(chunk, topic, "picture"):
                yield from (picture for picture in decode_pictures(chunk.data) if start <= picture[0] <= end)

    def film(self, start: float = -inf, end: float = inf) -> Iterator[tuple[float, bytes]]:
        """Yield the pictures of the film between `start` and `end`: their times, each a `FilmPicture`."""
        return ((time, picture) for _, time, picture in self.numbered_film(start, end))

    def numbered_film(self, start: float = -inf, end: float = inf) -> Iterator[tuple[int, float, bytes]]:
        """Yield these pictures with their numbers, which follow each other where none is missing."""
        for chunk in self.chunks(FILM.name, start, end):
            with _reading(chunk, FILM.name, "film"):
                for number, (time, picture) in enumerate(decode_pictures(chunk.data), chunk.first):
                    if start <= time <= end:
                        yield number, time, picture

    def columns(
        self, topic: str, names: Sequence[str], start: float = -inf, end: float = inf
    ) -> "tuple[Floats, dict[str, Floats]]":
        """Return the times of a topic of rows (s, steady clock), and columns by their names, in their units.

        Names are without units, such as "depth" or "position_2"; arrays have the shape (samples,). Raise
        KeyError on an unknown name.
        """
        import numpy as np  # only for comparisons and exports: it costs a small computer memory

        described = self.topics[topic]
        layout = row_layout(described)
        codes = "".join(field["code"] * field["count"] for field in described["fields"])
        # Struct's codes mean the same to NumPy.
        types = [np.dtype("<" + code) for code in codes]
        ends = np.cumsum([8, *(kind.itemsize for kind in types)]).tolist()
        for name in names:
            if name not in layout.names:
                raise KeyError(f"{topic} has no column {name}; it has {', '.join(layout.names)}")
        places = [layout.names.index(name) for name in names]
        # A chunk holds the first bytes of all its rows, then the second ones; the chosen ones are joined.
        offsets = np.concatenate([np.arange(8), *(np.arange(ends[at], ends[at + 1]) for at in places)])
        pieces = [
            table[:, offsets].transpose(1, 0, 2).reshape(len(offsets), -1)
            for table in self._tables(topic, start, end)
        ]
        whole = np.concatenate(pieces, axis=1) if pieces else np.empty((len(offsets), 0), np.uint8)

        def column(first: int, type_: "np.dtype[Any]") -> "Floats":
            rows = np.ascontiguousarray(whole[first : first + type_.itemsize].T)
            return rows.view(type_).reshape(-1).astype(np.float64)

        times = column(0, np.dtype("<f8"))
        inside = (times >= start) & (times <= end)
        values: dict[str, Floats] = {}
        first = 8
        for name, at in zip(names, places, strict=True):
            values[name] = (column(first, types[at]) * layout.scales[at])[inside]
            first += types[at].itemsize
        return times[inside], values

    def changes(self, topic: str) -> Iterator[dict[str, Any]]:
        """Yield the documents that differ from the previous one in more than their time."""
        before = b""
        for chunk in self._data(topic, -inf, inf):
            try:
                require_encoding(chunk.encoding, "documents")
                for line in unpack(chunk.data).splitlines():
                    content = line.partition(b",")[2]
                    if content != before:
                        before = content
                        yield json.loads(line)
            except (ValueError, KeyError) as problem:
                raise _damaged(chunk, topic, problem) from problem

    def _tables(self, topic: str, start: float, end: float) -> "Iterator[NDArray[np.uint8]]":
        """Yield the bytes of rows in the shape (chunks, size of a row, samples), of chunks of one length.

        One call of NumPy for each chunk would cost more than all else.
        """
        import numpy as np

        size = self.topics[topic]["row_bytes"]
        for length, alike in groupby(self._shuffled(topic, size, start, end), len):
            at_once = min(DATA_AT_ONCE, CHUNK_BYTES_MAX // max(length, 1))
            while some := list(islice(alike, at_once)):
                yield np.frombuffer(b"".join(some), np.uint8).reshape(len(some), size, -1)

    def _shuffled(self, topic: str, size: int, start: float, end: float) -> Iterator[bytes]:
        """Yield the rows of each chunk, of `size` bytes each, as `chunks.shuffle` left them.

        An hour has thousands of chunks: a context manager for each would cost a tenth of the time.
        """
        for chunk in self._data(topic, start, end):
            try:
                require_encoding(chunk.encoding, "rows")
                shuffled = unpack_rows(chunk.data, size)
            except ValueError as problem:
                raise _damaged(chunk, topic, problem) from problem
            yield shuffled

    def _data(self, topic: str, start: float, end: float) -> Iterator[Any]:
        """Yield number, encoding and data of such chunks; objects of a Session would take twice as long."""
        return self._select(_DATA, DATA_AT_ONCE, topic, start, end)

    def _select(
        self,
        query: Any,
        limit: int,
        topic: str,
        start: float,
        end: float,
    ) -> Iterator[Any]:
        """Yield the rows that `query` selects from chunks that may have samples in this range.

        At most `limit` are read at a time, and not many more bytes than `CHUNK_BYTES_MAX`.
        """
        with self._store.read() as database:
            first, last = self.numbers(database, topic, start, end)
        query = query.where(Chunk.session_id == self.row.id, Chunk.topic == topic)
        query = query.where(Chunk.last_time >= start, Chunk.first_time <= end)
        query = query.order_by(col(Chunk.number)).limit(limit)
        while first <= last:
            with self._store.read() as database:
                rows = database.connection().execute(query.where(col(Chunk.number).between(first, last)))
                batch = read_some(rows)
            if not batch:
                return
            yield from batch
            first = batch[-1].number + 1


def read_some(rows: Iterable[Any]) -> list[Any]:
    """Return the first of these rows of chunks, with about `CHUNK_BYTES_MAX` of `data` at most.

    Chunks of a foreign archive may be so large that a few fill the memory.
    """
    batch, size = [], 0
    for row in rows:
        batch.append(row)
        size += len(row.data)
        if size >= CHUNK_BYTES_MAX:
            break
    return batch


@contextmanager
def reading_content(row: SessionRow) -> Iterator[None]:
    """Raise RecordingError for content that this version does not expect, as from a foreign archive."""
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as problem:
        log.warning("session %s has unexpected content", row.id, exc_info=problem)
        raise RecordingError(f"its content is not as expected ({problem!r})") from problem


def depth_loop(state: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the depth loop of a recorded `state`: its set point, controller and choice of controllers.

    The first versions had these fields in the document itself, and no loops.
    """
    return next((loop for loop in state.get("loops", ()) if loop["name"] == "depth"), state)


@contextmanager
def _reading(chunk: Any, topic: str, kind: str) -> Iterator[None]:
    try:
        require_encoding(chunk.encoding, kind)
        yield
    except (ValueError, KeyError) as problem:
        raise _damaged(chunk, topic, problem) from problem


def _damaged(chunk: Any, topic: str, problem: Exception) -> RecordingError:
    if isinstance(problem, UnknownEncodingError):
        return RecordingError(
            f"chunk {chunk.number} of {topic} is of another version: {problem}. "
            f"Update µ-CAT on this computer, or leave {topic} out"
        )
    return RecordingError(f"chunk {chunk.number} of {topic} is damaged: {problem}")
