"""Requests from a lab to a robot's server. They block: not for the event loop."""

import json
import ssl
import urllib.error
import urllib.request
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from email.message import Message
from http.client import HTTPException, HTTPResponse
from pathlib import Path
from threading import Event
from typing import Any

from server.platform.models import LabRobotRow

SECONDS = 20.0
PAGE = 500
PIECE_BYTES = 1 << 18
PARTIAL = 206


class RobotAnswerError(Exception):
    """A request to a robot failed; the text is a sentence.

    `status` is that of its answer, 0 where it gave none.
    """

    def __init__(self, text: str, status: int = 0) -> None:
        super().__init__(text)
        self.status = status


class PullStoppedError(Exception):
    """The lab ends: what has arrived stays, and the rest is fetched later."""


@dataclass(frozen=True, slots=True)
class RobotsSession:
    """A session on a robot."""

    id: int
    identifier: str
    name: str
    archived: bool


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
    """Access to one robot; a download ends once `stopping` is set. All methods raise RobotAnswerError."""

    def __init__(self, robot: LabRobotRow, stopping: Event) -> None:
        self._url = f"{robot.url}/api"
        self._token = robot.token
        self._stopping = stopping
        context = ssl.create_default_context()
        if robot.certificate:
            # The robot's address changes, and its clock may not be set: it is known by the certificate alone.
            context = ssl.create_default_context(cadata=robot.certificate)
            context.check_hostname = False
        # No proxy: robots are in the lab's own network.
        self._opener = urllib.request.build_opener(
            urllib.request.ProxyHandler({}), urllib.request.HTTPSHandler(context=context)
        )

    def is_armed(self) -> bool:
        """Return whether the robot is armed; True where it does not say so."""
        return bool(self._ask("GET", "/robot").get("armed", True))

    def sessions(self) -> list[RobotsSession]:
        """Return the ended sessions outside the bin, newest first."""
        listed: list[RobotsSession] = []
        path: str | None = f"/sessions?limit={PAGE}"
        while path is not None:
            with self._open("GET", path) as answer:
                rows: list[Mapping[str, Any]] = _read(answer)
                path = _following(answer.headers)
            listed += [
                RobotsSession(row["id"], row["identifier"], row["name"], row["archived"] is not None)
                for row in rows
                if row["state"] != "recording"
            ]
        return listed

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

    def download(self, export: RobotsExport, path: Path) -> None:
        """Download an archive, or the rest of it. Raise OSError, and PullStoppedError where the lab ends."""
        there = path.stat().st_size if path.exists() else 0
        if there == export.bytes:
            return
        headers = {"range": f"bytes={there}-", "if-range": f'"{export.sha256}"'} if there else {}
        with (
            self._open("GET", f"/exports/{export.id}/file", headers=headers) as answer,
            path.open("ab" if answer.status == PARTIAL else "wb") as file,
        ):
            while piece := _receive(answer):
                file.write(piece)
                if self._stopping.is_set():
                    raise PullStoppedError

    def remove_export(self, export: RobotsExport) -> None:
        """Remove an archive from the robot's disk."""
        self._ask("DELETE", f"/exports/{export.id}")

    def note_archived(self, identifiers: Sequence[str]) -> None:
        """Tell the robot that these sessions are in the archive."""
        self._ask("POST", "/sessions/archived", {"identifiers": list(identifiers)})

    def _ask(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        with self._open(method, path, body) as answer:
            return _read(answer)

    def _open(
        self,
        method: str,
        path: str,
        body: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> HTTPResponse:
        data = None if body is None else json.dumps(body).encode()
        sent = {
            "authorization": f"Bearer {self._token}",
            "content-type": "application/json",
            **(headers or {}),
        }
        request = urllib.request.Request(self._url + path, data, sent, method=method)
        try:
            answer: HTTPResponse = self._opener.open(request, timeout=SECONDS)
        except urllib.error.HTTPError as problem:
            raise RobotAnswerError(_detail(problem), problem.code) from problem
        except (OSError, HTTPException) as problem:
            reason = getattr(problem, "reason", None) or problem
            raise RobotAnswerError(
                f"It does not answer at {self._url.removesuffix('/api')}: {reason}."
            ) from problem
        return answer


def _receive(answer: HTTPResponse) -> bytes:
    try:
        return answer.read(PIECE_BYTES)
    except (OSError, HTTPException) as problem:
        raise RobotAnswerError(f"The connection broke: {problem}. The rest is fetched later.") from problem


def _read(answer: HTTPResponse) -> Any:
    try:
        text = answer.read()
        return json.loads(text) if text else None
    except (OSError, HTTPException, ValueError) as problem:
        raise RobotAnswerError(f"Its answer cannot be read: {problem}.") from problem


def _detail(problem: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(problem)["detail"])
    except (ValueError, KeyError, TypeError, OSError):
        return f"It refused with status {problem.code}."


def _following(headers: Message) -> str | None:
    """Return the path below /api of the next page; None at the end."""
    link = headers.get("link", "")
    return link.partition("<")[2].partition(">")[0].removeprefix("/api") or None


def _export(job: Mapping[str, Any]) -> RobotsExport:
    return RobotsExport(
        id=job["id"],
        identifier=job["identifier"],
        state=job["state"],
        bytes=job["bytes"] or 0,
        sha256=job["sha256"] or "",
        problem=job["problem"],
    )
