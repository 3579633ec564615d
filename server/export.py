"""A session as a zip file of CSV files, written while it is read: neither is ever in memory as a whole."""

import csv
import io
import json
import re
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, cast

from sqlmodel import col, select

from server.chunks import DOCUMENTS_ENCODING, ROWS_ENCODING, decode_documents, decode_rows, row_layout
from server.models import Chunk, Gap, SessionRow
from server.sessions import from_row
from server.store import Store

CHUNKS_AT_ONCE = 32
LEVEL = 1


@dataclass(frozen=True, slots=True)
class Stored:
    """A chunk as it is read from the database."""

    number: int
    encoding: str
    data: bytes


class ExportError(Exception):
    """A recording that cannot be read; the text says what is wrong."""


class Export:
    """One session's download. What is committed while it is being written may or may not be in it."""

    def __init__(self, store: Store, session: SessionRow) -> None:
        self._store = store
        self._session = session
        self._topics: dict[str, dict[str, Any]] = json.loads(session.topics)

    @property
    def file_name(self) -> str:
        """When it began and what it is called, in characters that every file system takes."""
        started = datetime.fromtimestamp(self._session.started, UTC)
        words = re.sub(r"[^A-Za-z0-9]+", "-", self._session.name).strip("-")[:50]
        return f"{started:%Y-%m-%d_%H-%M-%S}_{words or self._session.id}.zip"

    def stream(self) -> Iterator[bytes]:
        """The zip file, piece by piece. Raises StoreError, ExportError."""
        sink = _Sink()
        with zipfile.ZipFile(cast("Any", sink), "w", zipfile.ZIP_DEFLATED, compresslevel=LEVEL) as archive:
            archive.writestr(
                "session.json", json.dumps(self._describe(), indent=2, ensure_ascii=False) + "\n"
            )
            for name, topic in self._topics.items():
                if not self._any(name):
                    continue
                with archive.open(f"{name}.csv", "w") as file:
                    for lines in self._lines(name, topic):
                        file.write(lines.encode())
                        yield from sink.take()
                yield from sink.take()
        yield from sink.take()

    def _describe(self) -> dict[str, Any]:
        row = self._session
        described: dict[str, Any] = from_row(row).model_dump(mode="json")
        with self._store.read() as database:
            gaps = database.exec(select(Gap).where(Gap.session_id == row.id).order_by(col(Gap.id)))
            described["gaps"] = [
                {
                    "topic": gap.topic,
                    "kind": gap.kind,
                    "time": gap.time - row.started_steady,
                    "missed": gap.missed,
                }
                for gap in gaps
            ]
        described["version"] = row.version
        described["started_steady"] = row.started_steady
        described["robot_state"] = json.loads(row.robot_state)
        described["configuration"] = row.configuration
        described["topics"] = self._topics
        return described

    def _lines(self, name: str, topic: dict[str, Any]) -> Iterator[str]:
        rows = topic["kind"] == "rows"
        encoding, size = (ROWS_ENCODING, topic["row_bytes"]) if rows else (DOCUMENTS_ENCODING, 0)
        header, write = self._row_writer(topic) if rows else self._document_writer(topic)
        yield _csv([["time [s]", "utc", *header]])
        for chunk in self._chunks(name):
            if chunk.encoding != encoding:
                raise ExportError(f"chunk {chunk.number} of {name} is encoded as {chunk.encoding!r}")
            try:
                yield write(decode_rows(chunk.data, size) if rows else chunk.data)
            except (ValueError, zlib.error) as problem:
                raise ExportError(f"chunk {chunk.number} of {name} is damaged: {problem}") from problem

    def _row_writer(self, topic: dict[str, Any]) -> tuple[tuple[str, ...], Any]:
        layout = row_layout(topic)

        def write(rows: bytes) -> str:
            lines = []
            for time, *counts in layout.row.iter_unpack(rows):
                values = tuple(count * scale for count, scale in zip(counts, layout.scales, strict=True))
                lines.append(f"{self._since_start(time)},{self._utc(time)},{layout.line % values}\n")
            return "".join(lines)

        return layout.columns, write

    def _document_writer(self, topic: dict[str, Any]) -> tuple[tuple[str, ...], Any]:
        columns = tuple(field["name"] for field in topic["fields"] if field["name"] != "time")

        def write(data: bytes) -> str:
            return _csv(
                [
                    self._since_start(document["time"]),
                    self._utc(document["time"]),
                    *(_cell(document.get(column)) for column in columns),
                ]
                for document in decode_documents(data)
            )

        return columns, write

    def _since_start(self, time: float) -> str:
        return f"{time - self._session.started_steady:.6f}"

    def _utc(self, time: float) -> str:
        moment = datetime.fromtimestamp(self._session.started + time - self._session.started_steady, UTC)
        return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")

    def _any(self, topic: str) -> bool:
        query = select(Chunk.id).where(Chunk.session_id == self._session.id, Chunk.topic == topic).limit(1)
        with self._store.read() as database:
            return database.exec(query).first() is not None

    def _chunks(self, topic: str) -> Iterator[Stored]:
        number = -1
        while True:
            query = (
                select(Chunk.number, Chunk.encoding, Chunk.data)
                .where(Chunk.session_id == self._session.id, Chunk.topic == topic, Chunk.number > number)
                .order_by(col(Chunk.number))
                .limit(CHUNKS_AT_ONCE)
            )
            with self._store.read() as database:
                found = [Stored(*one) for one in database.exec(query)]
            if not found:
                return
            yield from found
            number = found[-1].number


class _Sink:
    """What the zip file is written to; it cannot be sought in."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []

    def write(self, data: bytes) -> int:
        self._pieces.append(bytes(data))
        return len(data)

    def flush(self) -> None:
        """Nothing waits."""

    def take(self) -> Iterator[bytes]:
        pieces, self._pieces = self._pieces, []
        if pieces:
            yield b"".join(pieces)


def _csv(lines: Iterable[Iterable[str]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
