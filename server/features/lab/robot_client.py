"""Requests from a lab to a robot's server. They block: not for the event loop."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPResponse
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import AwareDatetime, Field, FiniteFloat, TypeAdapter, ValidationError

from server.http.pinned_requests import (
    OtherServerRefusedError,
    UnreachableError,
    known_by,
    open_answer,
    read_document,
    read_piece,
)
from server.library.schemas import ARCHIVED_MAX, SHOWN_MAX, SessionEdits
from server.platform.limits import NOTES_MAX
from server.platform.paired_robots import PairedRobot
from server.platform.schema_base import Schema

T = TypeVar("T")

SECONDS = 20.0
PIECE_BYTES = 1 << 14
"""Of a download: less than this is lost where the connection breaks."""
PARTIAL = 206
SIGNED_OUT = 401
REVOKED = (
    "It lets this lab in no more: somebody has revoked its token there, under People. Remove the robot here, "
    "and let it join again."
)


class RobotAnswerError(Exception):
    """A request to a robot failed; the text is a sentence.

    `status` is that of its answer, 0 where it gave none.
    """

    def __init__(self, text: str, status: int = 0) -> None:
        super().__init__(text)
        self.status = status


class PullStoppedError(Exception):
    """The pull ends: what has arrived stays, and the rest is fetched later."""


class RobotsBookmark(Schema):
    """A bookmark on a robot; `time` in s since the session's start."""

    time: FiniteFloat
    text: Annotated[str, Field(max_length=NOTES_MAX)]
    made: AwareDatetime


class RobotsTexts(Schema):
    """The texts of a session on a robot, which people change, and its dates, which the robot corrects."""

    name: Annotated[str, Field(max_length=1000)]
    note: Annotated[str, Field(max_length=NOTES_MAX)]
    tags: Annotated[list[Annotated[str, Field(max_length=1000)]], Field(max_length=1000)]
    marks: Annotated[list[RobotsBookmark], Field(max_length=SHOWN_MAX)]
    started: AwareDatetime
    ended: AwareDatetime


SESSIONS, TEXTS = TypeAdapter(list[SessionEdits]), TypeAdapter(RobotsTexts)


@dataclass(frozen=True, slots=True)
class RobotsExport:
    """An archive that a robot makes or has made."""

    id: str
    identifier: str
    state: str
    bytes: int
    sha256: str
    problem: str


class RobotClient:
    """Access to one robot.

    All methods raise RobotAnswerError, and PullStoppedError once `is_over` says so.
    """

    def __init__(self, robot: PairedRobot, is_over: Callable[[], bool]) -> None:
        self._robot = robot
        self._is_over = is_over

    def is_armed(self) -> bool:
        """Return whether the robot is armed; True where it does not say so."""
        return bool(self._ask("GET", "/robot").get("armed", True))

    def sessions(self) -> list[SessionEdits]:
        """Return the ended sessions outside the bin, newest first."""
        listed: list[SessionEdits] = []
        path = "/sessions/edits"
        while True:
            rows = self._read(SESSIONS, path)
            listed += rows
            if len(rows) < ARCHIVED_MAX:
                return listed
            path = f"/sessions/edits?before={rows[-1].id}"

    def texts(self, session: SessionEdits) -> RobotsTexts:
        """Return what people may have changed of a session."""
        return self._read(TEXTS, f"/sessions/{session.id}")

    def find_export(self, identifier: str) -> RobotsExport | None:
        """Return an archive of the session that the robot has or makes; None without one."""
        exports = (
            _export(job) for job in self._ask("GET", "/exports") if job["wanted"]["format"] == "archive"
        )
        usable = (
            export for export in exports if export.identifier == identifier and export.state != "failed"
        )
        return next(usable, None)

    def begin_export(self, session: int) -> RobotsExport:
        """Have the robot make an archive of a session."""
        return _export(self._ask("POST", "/exports", {"session": session, "format": "archive"}))

    def export(self, number: str) -> RobotsExport:
        """Return how far an archive is."""
        return _export(self._ask("GET", f"/exports/{number}"))

    def download(self, export: RobotsExport, path: Path, arrived: Callable[[int], None]) -> None:
        """Download an archive, or the rest of it; `arrived` is called with the bytes that are there.

        Raise OSError.
        """
        there = path.stat().st_size if path.exists() else 0
        if there == export.bytes:
            return
        headers = {"range": f"bytes={there}-", "if-range": f'"{export.sha256}"'} if there else {}
        with self._open("GET", f"/exports/{export.id}/file", headers=headers) as answer:
            there = there if answer.status == PARTIAL else 0
            with path.open("ab" if there else "wb") as file:
                while piece := read_piece(self._robot.address, answer, PIECE_BYTES):
                    file.write(piece)
                    there += len(piece)
                    arrived(there)
                    if self._is_over():
                        raise PullStoppedError
        if there != export.bytes:
            raise RobotAnswerError("The connection broke. The rest is fetched later.")

    def remove_export(self, export: RobotsExport) -> None:
        """Remove an archive from the robot's disk."""
        self._ask("DELETE", f"/exports/{export.id}")

    def note_archived(self, identifiers: Sequence[str]) -> None:
        """Tell the robot that these sessions are in the archive."""
        self._ask("POST", "/sessions/archived", {"identifiers": list(identifiers)})

    def _read(self, kind: TypeAdapter[T], path: str) -> T:
        try:
            return kind.validate_python(self._ask("GET", path))
        except ValidationError as problem:
            raise RobotAnswerError(f"Its answer to {path} is not valid: {problem}") from problem

    def _ask(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        with self._open(method, path, body) as answer:
            return read_document(self._robot.address, answer)

    @contextmanager
    def _open(
        self,
        method: str,
        path: str,
        body: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Iterator[HTTPResponse]:
        robot = self._robot
        if self._is_over():
            raise PullStoppedError
        if not robot.address:
            raise RobotAnswerError(
                "Its page is open to no other computer, so that nothing can be fetched. On the robot, set "
                "server.host in robot.toml, such as to 0.0.0.0."
            )
        try:
            with open_answer(
                robot.address,
                method,
                path,
                is_meant=known_by(robot.fingerprint),
                token=robot.token,
                body=body,
                headers=headers,
                seconds=SECONDS,
            ) as answer:
                yield answer
        except UnreachableError as problem:
            raise RobotAnswerError(str(problem)) from problem
        except OtherServerRefusedError as problem:
            text = REVOKED if problem.status == SIGNED_OUT else str(problem)
            raise RobotAnswerError(text, problem.status) from problem


def _export(job: Mapping[str, Any]) -> RobotsExport:
    return RobotsExport(
        id=job["id"],
        identifier=job["identifier"],
        state=job["state"],
        bytes=job["bytes"] or 0,
        sha256=job["sha256"] or "",
        problem=job["problem"],
    )
