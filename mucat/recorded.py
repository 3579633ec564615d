"""Reads samples as they lie in the database and in an archive: chunks, and descriptions of their fields.

`docs/reference/recordings.md` says how they are stored.
"""

import json
import sqlite3
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from mucat.errors import RobotError
from mucat.tables import SessionTables, TopicTable, si_column, text_of_value, typed_column
from robot_runtime.zip_members import find_members

DATABASE = "mucat.db"
ARCHIVE_FORMAT, ARCHIVE_VERSION = "mucat-session", 1
HEAD = struct.Struct("<IddqII16s")
"""Before a chunk of an archive: number, times (s), first sample, samples, bytes, encoding."""
CHUNK_BYTES_MAX = 16_000_000
TIME = "d"

StoredChunk = tuple[str, bytes]
"""Its encoding and its bytes."""
ABOUT = (
    *("identifier", "name", "note", "state", "robot", "version", "definitions", "started", "duration"),
    *("origin", "scenario_name", "seed", "firmware", "software", "configuration", "scenario"),
)
"""The columns of the table `session` that a program wants to know."""


def list_folder(folder: Path) -> list[dict[str, Any]]:
    """The sessions in a data folder, newest first; `id` is the number. Raises RobotError."""
    with _open_database(folder) as database:
        rows = database.execute("SELECT * FROM session WHERE deleted IS NULL ORDER BY id DESC").fetchall()
    return [{"id": row["id"], **_about(row)} for row in rows]


def read_folder(folder: Path, session: int) -> SessionTables:
    """A session in a data folder as tables. Raises RobotError."""
    with _open_database(folder) as database:
        row = database.execute("SELECT * FROM session WHERE id = ?", (session,)).fetchone()
        if row is None:
            raise RobotError(f"{folder} has no session {session}.")
        there = database.execute("SELECT DISTINCT topic FROM chunk WHERE session_id = ?", (session,))
        names = {one["topic"] for one in there}

    def chunks(topic: str) -> Iterator[StoredChunk]:
        query = "SELECT encoding, data FROM chunk WHERE session_id = ? AND topic = ? ORDER BY number"
        with _open_database(folder) as database:
            for one in database.execute(query, (session, topic)):
                yield one["encoding"], one["data"]

    return _tables(_about(row), json.loads(row["topics"]), row["started_steady"], names, chunks)


def read_archive(path: Path) -> SessionTables:
    """A session in an archive as tables. Raises RobotError, and BadZipFile, KeyError, ValueError, OSError."""
    with zipfile.ZipFile(path) as files:
        members = find_members(files, "session.json")
        content = json.loads(files.read(members["session.json"]))
        names = {name.removeprefix("chunks/") for name in members if name.startswith("chunks/")}
    if content.get("version") != ARCHIVE_VERSION:
        raise RobotError(f"{path} is an archive of another version. Install the same version of µ-CAT here.")
    session = content["session"]

    def chunks(topic: str) -> Iterator[StoredChunk]:
        with zipfile.ZipFile(path) as files, files.open(members[f"chunks/{topic}"]) as file:
            while head := file.read(HEAD.size):
                *_, size, encoding = HEAD.unpack(head)
                yield encoding.rstrip(b"\0").decode("ascii"), file.read(size)

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
    chunks: Callable[[str], Iterable[StoredChunk]],
) -> SessionTables:
    zero = (about["started"], steady)
    about["started"] = _iso(about["started"])
    readers = {
        name: partial(_read_topic, name, described, zero, chunks)
        for name, described in topics.items()
        if name in names and described["kind"] != "picture"
    }
    return SessionTables(about, readers)


def _read_topic(
    name: str,
    described: Mapping[str, Any],
    zero: tuple[float, float],
    chunks: Callable[[str], Iterable[StoredChunk]],
) -> TopicTable:
    read = _read_rows if described["kind"] == "rows" else _read_documents
    try:
        times, columns, units = read(described, chunks(name))
    except (ValueError, KeyError, zlib.error, struct.error, sqlite3.Error, zipfile.BadZipFile) as problem:
        raise RobotError(f"The topic {name} is damaged: {problem}.") from problem
    started, steady = zero
    head: dict[str, Sequence[Any]] = {
        "time": [round(time - steady, 6) for time in times],
        "utc": [_iso(started + time - steady, "milliseconds") for time in times],
    }
    return TopicTable({**head, **columns}, {"time": "s", **units})


def _read_rows(
    described: Mapping[str, Any], chunks: Iterable[StoredChunk]
) -> tuple[list[float], dict[str, Any], dict[str, str]]:
    fields = described["fields"]
    row = struct.Struct("<" + TIME + "".join(field["code"] * field["count"] for field in fields))
    values: list[list[Any]] = [[] for _ in row.unpack(bytes(row.size))]
    for encoding, data in chunks:
        _require(encoding, "shuffle-zlib")
        shuffled = _unpack(data)
        count = len(shuffled) // row.size
        if count * row.size != len(shuffled):
            raise ValueError(f"{len(shuffled)} bytes are not whole rows of {row.size}")
        rows = bytearray(len(shuffled))
        for place in range(row.size):
            # The first bytes of all rows lie side by side, then the second, and so on.
            rows[place :: row.size] = shuffled[place * count : (place + 1) * count]
        for known, found in zip(values, zip(*row.iter_unpack(rows), strict=True), strict=True):
            known.extend(found)
    times, *rest = values
    columns: dict[str, Sequence[Any]] = {}
    units: dict[str, str] = {}
    numbers = iter(rest)
    for field in fields:
        for place in range(field["count"]):
            name = f"{field['name']}_{place}" if field["count"] > 1 else field["name"]
            counts, scale = next(numbers), field["scale"]
            scaled = counts if scale == 1 else [one * scale for one in counts]
            name, unit, column = si_column(name, field["unit"], scaled)
            columns[name] = column
            if unit:
                units[name] = unit
    return times, columns, units


def _read_documents(
    described: Mapping[str, Any], chunks: Iterable[StoredChunk]
) -> tuple[list[float], dict[str, Any], dict[str, str]]:
    names = [field["name"] for field in described["fields"] if field["name"] != "time"]
    times: list[float] = []
    cells: dict[str, list[str]] = {name: [] for name in names}
    for encoding, data in chunks:
        _require(encoding, "lines-zlib")
        for line in _unpack(data).splitlines():
            document = json.loads(line)
            times.append(document["time"])
            for name in names:
                cells[name].append(text_of_value(document.get(name)))
    return times, {name: typed_column(column) for name, column in cells.items()}, {}


def _require(encoding: str, known: str) -> None:
    if encoding != known:
        raise ValueError(f"it is encoded as {encoding}, which this version cannot read")


def _unpack(data: bytes) -> bytes:
    unpacker = zlib.decompressobj()
    unpacked = unpacker.decompress(data, CHUNK_BYTES_MAX)
    if not unpacker.eof:
        raise ValueError("a chunk is cut off, or too large")
    return unpacked


def _iso(time: float, precision: str = "microseconds") -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec=precision).replace("+00:00", "Z")
