"""Reads samples as stored in the database and in an archive: chunks, and descriptions of their fields.

`docs/reference/recordings.md` says how they are stored.
"""

import json
import sqlite3
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from mucat.errors import RobotError
from mucat.tables import SessionTables, TopicTable, text_of_value, typed_column
from robot_runtime.contract.archive import CHUNKS, SESSION, VERSION, read_chunks
from robot_runtime.contract.chunks import (
    decode_documents,
    decode_rows,
    require_encoding,
    row_layout,
    si_fields,
)
from robot_runtime.zip_members import find_members

DATABASE = "mucat.db"

EncodedChunk = tuple[str, bytes]
"""Its encoding and its bytes."""
ABOUT = (
    *("identifier", "name", "note", "state", "robot", "version", "definitions", "started", "duration"),
    *("origin", "scenario_name", "seed", "firmware", "software", "configuration", "scenario"),
)
"""The columns of the table `session` that a program wants to know."""


def list_folder(folder: Path) -> list[dict[str, Any]]:
    """Return the sessions in a data folder, newest first; `id` is the number. Raise RobotError."""
    with _open_database(folder) as database:
        rows = database.execute("SELECT * FROM session WHERE deleted IS NULL ORDER BY id DESC").fetchall()
    return [{"id": row["id"], **_about(row)} for row in rows]


def read_folder(folder: Path, session: int) -> SessionTables:
    """Return a session in a data folder as tables. Raise RobotError."""
    with _open_database(folder) as database:
        row = database.execute("SELECT * FROM session WHERE id = ?", (session,)).fetchone()
        if row is None:
            raise RobotError(f"{folder} has no session {session}.")
        there = database.execute("SELECT DISTINCT topic FROM chunk WHERE session_id = ?", (session,))
        names = {record["topic"] for record in there}

    def chunks(topic: str) -> Iterator[EncodedChunk]:
        query = "SELECT encoding, data FROM chunk WHERE session_id = ? AND topic = ? ORDER BY number"
        with _open_database(folder) as database:
            for record in database.execute(query, (session, topic)):
                yield record["encoding"], record["data"]

    return _tables(_about(row), json.loads(row["topics"]), row["started_steady"], names, chunks)


def read_archive(path: Path) -> SessionTables:
    """Return a session in an archive as tables.

    Raise RobotError, and BadZipFile, KeyError, ValueError, OSError.
    """
    with zipfile.ZipFile(path) as files:
        members = find_members(files, SESSION)
        content = json.loads(files.read(members[SESSION]))
        names = {name.removeprefix(CHUNKS) for name in members if name.startswith(CHUNKS)}
    if content.get("version") != VERSION:
        raise RobotError(f"{path} is an archive of another version. Install the same version of µ-CAT here.")
    session = content["session"]

    def chunks(topic: str) -> Iterator[EncodedChunk]:
        with zipfile.ZipFile(path) as files, files.open(members[CHUNKS + topic]) as file:
            for chunk in read_chunks(file):
                yield chunk.encoding, chunk.data

    return _tables(_about(session), session["topics"], session["started_steady"], names, chunks)


def _open_database(folder: Path) -> closing[sqlite3.Connection]:
    path = folder / DATABASE
    if not path.is_file():
        raise RobotError(f"{folder} is no data folder of µ-CAT: it has no {DATABASE}.")
    try:
        # Read-only, so that it may be open in a running server.
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
        connection.row_factory = sqlite3.Row
        connection.execute("SELECT 1 FROM session").fetchone()
    except sqlite3.Error as problem:
        raise RobotError(f"{path} cannot be read: {problem}.") from problem
    return closing(connection)


def _about(row: Any) -> dict[str, Any]:
    there = set(row.keys())
    return {name: row[name] for name in ABOUT if name in there}


def _tables(
    about: dict[str, Any],
    topics: Mapping[str, Any],
    steady: float,
    names: set[str],
    chunks: Callable[[str], Iterable[EncodedChunk]],
) -> SessionTables:
    zero = (about["started"], steady)
    about["started"] = _iso(about["started"])
    readers = {
        name: partial(_read_topic, name, described, zero, chunks)
        for name, described in topics.items()
        if name in names and described["kind"] in ("rows", "documents")
    }
    return SessionTables(about, readers)


def _read_topic(
    name: str,
    described: Mapping[str, Any],
    zero: tuple[float, float],
    chunks: Callable[[str], Iterable[EncodedChunk]],
) -> TopicTable:
    read = _read_rows if described["kind"] == "rows" else _read_documents
    try:
        times, columns, units = read(described, chunks(name))
    except (ValueError, KeyError, sqlite3.Error, zipfile.BadZipFile) as problem:
        raise RobotError(f"The topic {name} is damaged: {problem}.") from problem
    started, steady = zero
    head: dict[str, Sequence[Any]] = {
        "time": [round(time - steady, 6) for time in times],
        "utc": [_iso(started + time - steady, "milliseconds") for time in times],
    }
    return TopicTable({**head, **columns}, {"time": "s", **units})


def _read_rows(
    described: Mapping[str, Any], chunks: Iterable[EncodedChunk]
) -> tuple[list[float], dict[str, Any], dict[str, str]]:
    row = row_layout(described).row
    values: list[list[Any]] = [[] for _ in row.unpack(bytes(row.size))]
    for encoding, data in chunks:
        require_encoding(encoding, "rows")
        rows = row.iter_unpack(decode_rows(data, row.size))
        for known, added in zip(values, zip(*rows, strict=True), strict=True):
            known.extend(added)
    times, *rest = values
    columns: dict[str, Sequence[Any]] = {}
    units: dict[str, str] = {}
    numbers = iter(rest)
    for field in si_fields(described):
        for name in field.columns:
            counts = next(numbers)
            columns[name] = counts if field.scale == 1 else [count * field.scale for count in counts]
            if field.unit:
                units[name] = field.unit
    return times, columns, units


def _read_documents(
    described: Mapping[str, Any], chunks: Iterable[EncodedChunk]
) -> tuple[list[float], dict[str, Any], dict[str, str]]:
    names = [field["name"] for field in described["fields"] if field["name"] != "time"]
    times: list[float] = []
    cells: dict[str, list[str]] = {name: [] for name in names}
    for encoding, data in chunks:
        require_encoding(encoding, "documents")
        for document in decode_documents(data):
            times.append(document["time"])
            for name in names:
                cells[name].append(text_of_value(document.get(name)))
    return times, {name: typed_column(column) for name, column in cells.items()}, {}


def _iso(time: float, precision: str = "microseconds") -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec=precision).replace("+00:00", "Z")
