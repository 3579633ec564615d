"""A session as a zip file of CSV files, written while it is read: neither is ever in memory as a whole."""

import csv
import io
import json
import re
import zipfile
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any, cast

from sqlmodel import col, select

from server.chunks import row_layout
from server.models import Gap, SessionRow
from server.recording import Recording
from server.sessions import from_row
from server.store import Store

LEVEL = 1


class Export:
    """One session's download. What is committed while it is being written may or may not be in it."""

    def __init__(self, store: Store, session: SessionRow) -> None:
        self._store = store
        self._session = session
        self._recording = Recording(store, session)

    @property
    def file_name(self) -> str:
        """When it began and what it is called, in characters that every file system takes."""
        started = datetime.fromtimestamp(self._session.started, UTC)
        words = re.sub(r"[^A-Za-z0-9]+", "-", self._session.name).strip("-")[:50]
        return f"{started:%Y-%m-%d_%H-%M-%S}_{words or self._session.id}.zip"

    def stream(self) -> Iterator[bytes]:
        """The zip file, piece by piece. Raises StoreError, RecordingError."""
        sink = _Sink()
        with zipfile.ZipFile(cast("Any", sink), "w", zipfile.ZIP_DEFLATED, compresslevel=LEVEL) as archive:
            archive.writestr(
                "session.json", json.dumps(self._describe(), indent=2, ensure_ascii=False) + "\n"
            )
            counts = self._recording.counts()
            for name, topic in self._recording.topics.items():
                if name not in counts or topic["kind"] == "picture":
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
        described["topics"] = self._recording.topics
        return described

    def _lines(self, name: str, topic: dict[str, Any]) -> Iterator[str]:
        if topic["kind"] == "rows":
            columns, write = self._row_writer(topic)
            yield _csv([["time [s]", "utc", *columns]])
            for rows in self._recording.rows(name):
                yield write(rows)
        else:
            header = tuple(field["name"] for field in topic["fields"] if field["name"] != "time")
            yield _csv([["time [s]", "utc", *header]])
            for document in self._recording.documents(name):
                yield self._line(document, header)

    def _row_writer(self, topic: dict[str, Any]) -> tuple[tuple[str, ...], Any]:
        layout = row_layout(topic)

        def write(rows: bytes) -> str:
            lines = []
            for time, *counts in layout.row.iter_unpack(rows):
                values = tuple(count * scale for count, scale in zip(counts, layout.scales, strict=True))
                lines.append(f"{self._since_start(time)},{self._utc(time)},{layout.line % values}\n")
            return "".join(lines)

        return layout.columns, write

    def _line(self, document: dict[str, Any], columns: Sequence[str]) -> str:
        time = document["time"]
        cells = (_cell(document.get(column)) for column in columns)
        return _csv([[self._since_start(time), self._utc(time), *cells]])

    def _since_start(self, time: float) -> str:
        return f"{time - self._session.started_steady:.6f}"

    def _utc(self, time: float) -> str:
        moment = datetime.fromtimestamp(self._session.started + time - self._session.started_steady, UTC)
        return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


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
