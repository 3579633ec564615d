"""Recorded sessions as tables with units: from a robot's server, or from an exported file."""

import csv
import io
import json
import re
import time
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mucat.address import RobotAddress
from mucat.errors import RobotError

POLL_SECONDS = 0.2
HEADED = re.compile(r"(?P<name>.*?)(?: \[(?P<unit>.*)\])?")
"""The head of a column: its name, and its unit."""


class SessionTables:
    """The topics of one session: columns by name, and their units. `about` is its `session.json`."""

    def __init__(
        self,
        about: Mapping[str, Any],
        columns: Mapping[str, Mapping[str, Sequence[Any]]],
        units: Mapping[str, Mapping[str, str]],
    ) -> None:
        self.about = about
        self._columns = columns
        self._units = units

    @property
    def topics(self) -> list[str]:
        """The topics that it has."""
        return [*self._columns]

    def units(self, topic: str) -> dict[str, str]:
        """The units of a topic's columns; those without one are left out. Raises RobotError."""
        self._require(topic)
        return dict(self._units[topic])

    def pandas(self, topic: str) -> Any:
        """A topic as a pandas DataFrame, with the units in its `attrs`. Raises RobotError."""
        self._require(topic)
        import pandas

        frame = pandas.DataFrame(self._columns[topic])
        frame.attrs["units"] = self.units(topic)
        return frame

    def polars(self, topic: str) -> Any:
        """A topic as a polars DataFrame; `units` says the units. Raises RobotError."""
        self._require(topic)
        import polars

        return polars.DataFrame(dict(self._columns[topic]))

    def _require(self, topic: str) -> None:
        if topic not in self._columns:
            raise RobotError(f"The session has no topic {topic}; it has {', '.join(self._columns)}.")


class Sessions:
    """The sessions of a robot's server. Every method raises RobotError."""

    def __init__(self, url: str, token: str) -> None:
        self._address = RobotAddress(url, token)

    def list(self) -> "list[dict[str, Any]]":
        """All sessions, as the server lists them."""
        found: list[dict[str, Any]] = self._address.ask("GET", "/sessions")
        return found

    def load(self, session: int) -> SessionTables:
        """A session as tables. The server writes an export of it, which needs the role of an operator."""
        job = self._address.ask("POST", "/exports", {"session": session, "format": "csv"})
        while job["state"] in ("waiting", "running"):
            time.sleep(POLL_SECONDS)
            job = self._address.ask("GET", f"/exports/{job['id']}")
        if job["state"] != "done":
            raise RobotError(f"The session {session} could not be exported: {job['problem']}")
        data = self._address.fetch("GET", f"/exports/{job['id']}/file")
        self._address.ask("DELETE", f"/exports/{job['id']}")
        return _read_tables(io.BytesIO(data))

    def compare(self, sessions: Sequence[int], signals: Sequence[str]) -> dict[str, Any]:
        """Lines and figures of several sessions side by side, as `POST /api/compare` answers."""
        asked = {"sessions": [*sessions], "signals": [*signals]}
        found: dict[str, Any] = self._address.ask("POST", "/compare", asked)
        return found

    @staticmethod
    def read(file: Path | str) -> SessionTables:
        """A session from a file that `mucat export` wrote with `--format csv`. Raises RobotError."""
        try:
            with Path(file).open("rb") as opened:
                return _read_tables(opened)
        except OSError as problem:
            raise RobotError(f"{file} cannot be read: {problem.strerror}.") from problem


def _read_tables(file: Any) -> SessionTables:
    columns: dict[str, dict[str, list[Any]]] = {}
    units: dict[str, dict[str, str]] = {}
    try:
        with zipfile.ZipFile(file) as files:
            about = json.loads(files.read("session.json"))
            for name in files.namelist():
                if name.endswith(".csv") and "/" not in name:
                    topic = name.removesuffix(".csv")
                    with files.open(name) as opened:
                        columns[topic], units[topic] = _read_table(opened)
    except (zipfile.BadZipFile, KeyError, ValueError) as problem:
        raise RobotError("The file is no export of a session in the format csv.") from problem
    return SessionTables(about, columns, units)


def _read_table(opened: Any) -> tuple[dict[str, list[Any]], dict[str, str]]:
    rows = csv.reader(io.TextIOWrapper(opened, "utf-8-sig", newline=""))
    names: list[str] = []
    units: dict[str, str] = {}
    for head in next(rows, []):
        found = HEADED.fullmatch(head)
        assert found is not None
        name = found["name"] if found["name"] not in names else "board_time"
        names.append(name)
        if found["unit"]:
            units[name] = found["unit"]
    values = [[_value(cell) for cell in column] for column in zip(*rows, strict=True)]
    return dict(zip(names, values or [[] for _ in names], strict=True)), units


def _value(cell: str) -> float | str:
    try:
        return float(cell)
    except ValueError:
        return cell
