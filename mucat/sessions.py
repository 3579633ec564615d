"""Recorded sessions as tables with units: of a robot's server, of a data folder, or of a file."""

import json
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from mucat.address import RobotAddress
from mucat.csv_export import read_csv_export
from mucat.errors import RobotError
from mucat.mcap_export import MAGIC, read_mcap
from mucat.pictures import decode_picture
from mucat.recorded import list_folder, read_archive, read_folder
from mucat.tables import SessionTables
from robot_runtime.contract.archive import FORMAT
from robot_runtime.zip_members import find_members

POLL_SECONDS = 0.2
PAGE = 500
"""Sessions in one answer of the server, at most."""
Entries = list[dict[str, Any]]


class Sessions:
    """The sessions of a robot's server. Every method raises RobotError."""

    def __init__(self, url: str, token: str) -> None:
        self._address = RobotAddress(url, token)

    def list(self, search: str = "") -> "list[dict[str, Any]]":
        """Return all sessions, newest first, as the server lists them.

        With `search`, return those that have each of its words in name, note, tags or scenario.
        """
        sessions: list[dict[str, Any]] = []
        query = {"search": search, "limit": PAGE}
        while True:
            page = self._address.ask("GET", f"/sessions?{urlencode(query)}")
            sessions += page
            if len(page) < PAGE:
                return sessions
            query["before"] = page[-1]["id"]

    def load(self, session: int) -> SessionTables:
        """Return a session as tables.

        The server writes an export of it, which needs the role of an operator.
        """
        job = self._address.ask("POST", "/exports", {"session": session, "format": "csv"})
        while job["state"] in ("waiting", "running"):
            time.sleep(POLL_SECONDS)
            job = self._address.ask("GET", f"/exports/{job['id']}")
        if job["state"] != "done":
            raise RobotError(f"The session {session} could not be exported: {job['problem']}")
        data = self._address.fetch("GET", f"/exports/{job['id']}/file")
        self._address.ask("DELETE", f"/exports/{job['id']}")
        return read_csv_export(data)

    def compare(self, sessions: Sequence[int], signals: Sequence[str]) -> dict[str, Any]:
        """Return lines and figures of several sessions side by side, as `POST /api/compare` answers."""
        asked = {"sessions": [*sessions], "signals": [*signals]}
        comparison: dict[str, Any] = self._address.ask("POST", "/compare", asked)
        return comparison

    def events(self, session: int) -> Entries:
        """Return the events of a session in order of time: `time` (s), `kind`, `severity`, `text`."""
        return [*self._timeline(session)["events"]]

    def marks(self, session: int) -> Entries:
        """Return the bookmarks of a session in order of time: `id`, `time` (s), `text`."""
        return [*self._timeline(session)["markers"]]

    def mark(self, session: int, time: float, text: str = "") -> None:
        """Bookmark a moment (s since the session's start), with a note in Markdown if one is given."""
        self._address.ask("POST", f"/sessions/{session}/markers", {"time": time, "text": text})

    def figures(
        self, session: int, start: float | None = None, end: float | None = None
    ) -> "dict[str, float | None]":
        """Return the figures of a session's armed time, or from `start` to `end` (s), in SI units by name.

        A figure is None where it is not one number, as the overshoot of several steps.
        """
        part = {name: value for name, value in (("from", start), ("to", end)) if value is not None}
        query = f"?{urlencode(part)}" if part else ""
        figures = self._address.ask("GET", f"/sessions/{session}/story/figures{query}")["whole"]
        return {name: figure["value"] for name, figure in figures.items()}

    def picture(self, session: int, time: float) -> Any:
        """Return the first small camera picture from this time (s) on, as `Robot.picture` does."""
        return decode_picture(self._address.fetch("GET", f"/sessions/{session}/thumbnail?time={time!r}"))

    def snapshot(self, session: int, time: float) -> Any:
        """Return the first snapshot from this time (s) on, at full size."""
        return decode_picture(self._address.fetch("GET", f"/sessions/{session}/snapshot?time={time!r}"))

    def _timeline(self, session: int) -> "dict[str, Any]":
        timeline: dict[str, Any] = self._address.ask("GET", f"/sessions/{session}/timeline")
        return timeline

    @staticmethod
    def read(file: Path | str) -> SessionTables:
        """Return a session of a file that `mucat export` wrote as csv, mcap or archive. Raise RobotError."""
        path = Path(file)
        try:
            with path.open("rb") as opened:
                if opened.read(len(MAGIC)) == MAGIC:
                    return read_mcap(path)
            with zipfile.ZipFile(path) as files:
                described = files.read(find_members(files, "session.json")["session.json"])
            archived = json.loads(described).get("format") == FORMAT
            return read_archive(path) if archived else read_csv_export(path)
        except OSError as problem:
            raise RobotError(f"{file} cannot be read: {problem.strerror}.") from problem
        except (zipfile.BadZipFile, LookupError, ValueError, AttributeError) as problem:
            raise RobotError(f"{file} is no export of a session as csv, mcap or archive.") from problem


class FolderSessions:
    """The sessions in a data folder of this computer, which a running server may use.

    Every method raises RobotError.
    """

    def __init__(self, folder: Path | str) -> None:
        self._folder = Path(folder)

    def list(self) -> "list[dict[str, Any]]":
        """Return all sessions, newest first."""
        return list_folder(self._folder)

    def load(self, session: int) -> SessionTables:
        """Return a session as tables."""
        return read_folder(self._folder, session)
