"""The audit log of all requests over HTTP, and of STOP on the live socket."""

import json
import logging
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from robot_runtime.clock import Clock
from server.http.dependencies import find_service
from server.http.security import DOORS, SAFE_METHODS
from server.http.sign_in.confirmation import UNCONFIRMED
from server.http.sign_in.identity import IDENTITY, Identity
from server.http.sign_in.policy import Need, need_of
from server.platform.audit_file import FILES_MOST, AuditEntry, Outcome, Series, append_entries, clean

log = logging.getLogger(__name__)

UNCHANGING = frozenset(
    {
        "checkTestDocument",
        "checkScenario",
        "checkSweep",
        "checkMission",
        "compareSessions",
        "compareLines",
        "pickColour",
        "predictStep",
        "readVision",
        "refuseCommand",
    }
)
"""Operations that are sent as POST, and change nothing."""
DOWNLOADS = frozenset({"downloadBackup", "downloadExport", "exportAudit"})
"""Operations that are sent as GET, and take data out of the robot."""
REFUSED = frozenset({401, 403, 409, 413, 422, 423, 429})
ALWAYS_RECORDED = frozenset({401, 403, 429})
"""Refusals that are in the log also where they concern something that changes nothing."""
ARMING = {"commandArm": "armed the robot", "startMission": "started a mission"}
NOTICED = {**ARMING, "stopRobot": "pressed STOP"}
"""Acts that are also a notice, and so an event of what is being recorded; those of `ARMING` may begin it."""
UNROUTED = "Request"
"""The action of what was refused before it was known which operation it is."""
BODY_BYTES = 2048
NOTICE_SECONDS = 1.0
"""The same notice is not written again within this time: a page sends STOP on two ways."""
SECRETS = frozenset({"code", "token"})
"""Entries of a request's body that are not stored."""
SOCKET_REFUSED = 403
"""Stands for a live socket that was closed before it was accepted."""
SIGNING = frozenset({"pairBrowser", "signOut", "openReadingLink", "makeReadingLink", "endReadingLink"})
DELETING = frozenset({"purgeSession", "importSession"})
"""Operations whose entries are with those of other deletions, which are sent as DELETE."""
QUERY_MAX = 100
"""Characters of a query that are written."""
WINDOW = 3600.0
LIMIT, LIMIT_OPERATOR = 60, 600
"""Entries of one device (all who are not signed in are one) about one action in an hour; the second is also
that of all actions of a series together. Further ones are counted: nobody can push others' acts out of the
log, or fill the disk."""
PENDING_MOST = 1000
"""The greatest number of entries that wait in memory while the disk takes none."""


_Written = tuple[Series, AuditEntry]


@dataclass(slots=True)
class _Window:
    """The entries of one device about one action, or of one series, since `begun` (s, steady clock);
    `left_out` is the last of those that were only counted."""

    begun: float
    series: Series
    entries: int = 0
    left_out: AuditEntry | None = None

    def admit(self, entry: AuditEntry, most: int) -> bool:
        """Count an entry; return False where there are too many, so that it is only counted."""
        self.entries += 1
        if self.entries <= most:
            return True
        count = 1 if self.left_out is None else self.left_out.count + 1
        self.left_out = replace(entry, count=count)
        return False


class AuditLog:
    """The log's writer, in a thread of its own: no request waits for the disk, STOP least of all."""

    def __init__(self, folder: Path, clock: Clock, notice: Callable[[str, str], None]) -> None:
        self.folder = folder
        self._clock = clock
        self.notice = notice
        self._noticed = -NOTICE_SECONDS, ""
        self._windows: dict[tuple[int | None, str, str], _Window] = {}
        self._pending: list[_Written] = []
        self._thread = ThreadPoolExecutor(1, "audit")

    def record(
        self,
        identity: Identity | None,
        address: str,
        action: str,
        about: str,
        outcome: Outcome,
        operation: str = "",
        series: Series = "",
    ) -> None:
        """Add an entry. `operation` is the name of an operation of the HTTP interface, if the act is one.

        `series` is that of the entry where the act was done, but for arming, which is known by `operation`.
        """
        entry = AuditEntry(
            time=time.time(),
            who=identity.name if identity else "",
            device=identity.device if identity else None,
            role=identity.role if identity else "",
            address=address,
            action=action,
            about=clean(about),
            outcome=outcome,
        )
        entries = self._end_windows()
        of: Series = "" if outcome != "done" else "arming" if operation in ARMING else series
        if self._admit(entry, of):
            entries.append((of, entry))
            if outcome == "done" and identity is not None and operation in NOTICED:
                self._notify(operation, f"“{identity.name}” {NOTICED[operation]}.")
        if entries:
            self._thread.submit(self._write, entries)

    def close(self) -> None:
        """Write the waiting entries. Blocks; call it once."""
        self._thread.submit(self._write, self._end_windows(everything=True))
        self._thread.shutdown()

    def _notify(self, operation: str, text: str) -> None:
        now, (before, noticed) = self._clock.now(), self._noticed
        if text != noticed or now - before >= NOTICE_SECONDS:
            self._noticed = now, text
            self.notice(operation, text)

    def _admit(self, entry: AuditEntry, series: Series) -> bool:
        """Count an entry; return False where there are too many of its kind, so that it is only counted."""
        operator = entry.role == "operator" and entry.outcome == "done"
        of_action = self._window(entry.device, entry.action, entry.outcome, series)
        of_series = self._window(entry.device, "", series, series)
        return of_action.admit(entry, LIMIT_OPERATOR if operator else LIMIT) and of_series.admit(
            entry, LIMIT_OPERATOR
        )

    def _window(self, device: int | None, action: str, kind: str, series: Series) -> _Window:
        return self._windows.setdefault((device, action, kind), _Window(self._clock.now(), series))

    def _end_windows(self, *, everything: bool = False) -> list[_Written]:
        """Return the counts of windows that have ended."""
        before = self._clock.now() - WINDOW
        over = [key for key, window in self._windows.items() if everything or window.begun <= before]
        ended = [self._windows.pop(key) for key in over]
        return [(window.series, window.left_out) for window in ended if window.left_out is not None]

    def _write(self, entries: list[_Written]) -> None:
        waiting, self._pending = [*self._pending, *entries], []
        for series in FILES_MOST:
            of_series = [entry for of, entry in waiting if of == series]
            if not of_series:
                continue
            try:
                append_entries(self.folder, of_series, series)
            except OSError as problem:
                log.warning("%d entries of the audit log wait: %s", len(of_series), problem)
                self._pending += [(series, entry) for entry in of_series]
        self._pending = self._pending[-PENDING_MOST:]


class AuditMiddleware:
    """ASGI middleware: writes each request, its caller and its outcome.

    It is the outermost one, and so sees all refusals.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, and write the entry once it is answered."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        request = _Request(scope, receive, send)
        try:
            await self._app(scope, request.receive, request.send)
        finally:
            audit = find_service(HTTPConnection(scope), AuditLog)
            if scope["type"] == "http":
                request.record(audit)
            elif request.status == SOCKET_REFUSED:
                action = "Open a door" if scope["path"] in DOORS else "Open the live socket"
                audit.record(caller_of(scope), address_of(scope), action, "", "refused")


class _Request:
    """One request: the messages that pass between server and application."""

    def __init__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self._scope = scope
        self._receive = receive
        self._send = send
        self._body = b""
        self._identity: Identity | None = None
        self._accepted = False
        self.status = 0

    async def receive(self) -> Message:
        """Return the next message to the application; the first bytes of the body are stored."""
        message = await self._receive()
        self._identity = self._identity or caller_of(self._scope)
        if message["type"] == "http.request" and len(self._body) <= BODY_BYTES:
            self._body += message.get("body", b"")[: BODY_BYTES + 1]
        return message

    async def send(self, message: Message) -> None:
        """Pass a message of the application on."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
        elif message["type"] == "websocket.accept":
            self._accepted = True
        elif message["type"] == "websocket.close" and not self._accepted:
            self.status = SOCKET_REFUSED
        await self._send(message)

    def record(self, audit: AuditLog) -> None:
        """Write the entry, if it needs one."""
        route, method = self._scope.get("route"), self._scope["method"]
        operation = str(getattr(route, "operation_id", None) or "")
        changes = method not in SAFE_METHODS and operation not in UNCHANGING
        if not (changes or operation in DOWNLOADS or self.status in ALWAYS_RECORDED):
            return
        # No path: there must not be as many actions as a caller likes to invent.
        action = str(getattr(route, "summary", None) or UNROUTED).partition(". ")[0]
        # Whoever has signed out, or was revoked meanwhile, was still somebody.
        identity = caller_of(self._scope) or self._identity
        outcome = _outcome(self.status)
        series = _series_of(route, method, operation)
        audit.record(identity, address_of(self._scope), action, self._describe(), outcome, operation, series)

    def _describe(self) -> str:
        query = self._scope.get("query_string", b"")[:QUERY_MAX].decode(errors="replace")
        body = self._read_body()
        asked = f"{self._scope['method']} {self._scope['path']}" + (f"?{query}" if query else "")
        if UNCONFIRMED in self._scope:
            asked = f"not confirmed: {asked}"
        return f"{asked} {json.dumps(body, ensure_ascii=False)}" if body else asked

    def _read_body(self) -> dict[str, Any]:
        if not self._body or len(self._body) > BODY_BYTES:
            return {}
        try:
            body = json.loads(self._body)
        except (ValueError, RecursionError):
            return {}
        return (
            {key: value for key, value in body.items() if key not in SECRETS}
            if isinstance(body, dict)
            else {}
        )


def caller_of(scope: Scope) -> Identity | None:
    """Return the identity found by the sign-in check, if any."""
    identity = scope.get(IDENTITY)
    return identity if isinstance(identity, Identity) else None


def address_of(scope: Scope) -> str:
    """Return the caller's address; empty where the server does not know it."""
    client = scope.get("client")
    return str(client[0]) if client else ""


def _series_of(route: object, method: str, operation: str) -> Series:
    if need_of(route) is Need.ADMINISTER or operation in SIGNING:
        return "access"
    return "deletion" if method == "DELETE" or operation in DELETING else ""


def _outcome(status: int) -> Outcome:
    if 200 <= status < 400:
        return "done"
    return "refused" if status in REFUSED else "failed"
