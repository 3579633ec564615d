"""The audit log of everything that is asked of the server over HTTP, and of STOP on the live socket."""

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
from server.platform.audit_file import AuditEntry, Outcome, append_entries, clean

log = logging.getLogger(__name__)

UNCHANGING = frozenset(
    {
        "checkTestDocument",
        "checkScenario",
        "checkMission",
        "compareSessions",
        "compareLines",
        "pickColour",
        "readVision",
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
SECRETS = frozenset({"code"})
"""Entries of a request's body that are not stored."""
SOCKET_REFUSED = 403
"""Stands for a live socket that was closed before it was accepted."""
WINDOW = 3600.0
LIMIT, LIMIT_OPERATOR = 60, 600
"""Entries of one device (all who are not signed in are one) about one action in an hour. Further ones are
counted: nobody can push others' acts out of the log, or fill the disk."""
PENDING_MOST = 1000
"""The greatest number of entries that wait in memory while the disk takes none."""


@dataclass(slots=True)
class _Window:
    """The entries of one device about one action since `begun` (s, steady clock); `left_out` is the last of
    those that were only counted."""

    begun: float
    entries: int = 0
    left_out: AuditEntry | None = None


class AuditLog:
    """Writes the log in a thread of its own: nobody waits for the disk, STOP least of all."""

    def __init__(self, folder: Path, clock: Clock, notice: Callable[[str, str], None]) -> None:
        self.folder = folder
        self._clock = clock
        self._notice = notice
        self._noticed = -NOTICE_SECONDS, ""
        self._windows: dict[tuple[int | None, str, Outcome], _Window] = {}
        self._pending: list[AuditEntry] = []
        self._thread = ThreadPoolExecutor(1, "audit")

    def record(
        self,
        identity: Identity | None,
        address: str,
        action: str,
        about: str,
        outcome: Outcome,
        operation: str = "",
    ) -> None:
        """Add an entry. `operation` is the name of an operation of the HTTP interface, if it is one."""
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
        if self._admit(entry):
            entries.append(entry)
            if outcome == "done" and identity is not None and operation in NOTICED:
                self._notify(operation, f"“{identity.name}” {NOTICED[operation]}.")
        if entries:
            self._thread.submit(self._write, entries)

    def close(self) -> None:
        """Write what is still waiting. Blocks; call it once."""
        self._thread.submit(self._write, self._end_windows(everything=True))
        self._thread.shutdown()

    def _notify(self, operation: str, text: str) -> None:
        now, (before, said) = self._clock.now(), self._noticed
        if text != said or now - before >= NOTICE_SECONDS:
            self._noticed = now, text
            self._notice(operation, text)

    def _admit(self, entry: AuditEntry) -> bool:
        """Count an entry; False where there are too many of its kind, so that it is only counted."""
        operator = entry.role == "operator" and entry.outcome == "done"
        window = self._windows.setdefault(
            (entry.device, entry.action, entry.outcome), _Window(self._clock.now())
        )
        window.entries += 1
        if window.entries <= (LIMIT_OPERATOR if operator else LIMIT):
            return True
        count = 1 if window.left_out is None else window.left_out.count + 1
        window.left_out = replace(entry, count=count)
        return False

    def _end_windows(self, *, everything: bool = False) -> list[AuditEntry]:
        """The counts of windows that have ended."""
        before = self._clock.now() - WINDOW
        over = [key for key, one in self._windows.items() if everything or one.begun <= before]
        ended = [self._windows.pop(key) for key in over]
        return [one.left_out for one in ended if one.left_out is not None]

    def _write(self, entries: list[AuditEntry]) -> None:
        self._pending = [*self._pending, *entries][-PENDING_MOST:]
        if not self._pending:
            return
        try:
            append_entries(self.folder, self._pending)
        except OSError as problem:
            log.warning("%d entries of the audit log wait: %s", len(self._pending), problem)
        else:
            self._pending = []


class AuditMiddleware:
    """ASGI middleware: writes what was asked, by whom, and how it ended.

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
        """The next message to the application; the first bytes of the body are remembered."""
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
        audit.record(identity, address_of(self._scope), action, self._describe(), outcome, operation)

    def _describe(self) -> str:
        query = self._scope.get("query_string", b"").decode(errors="replace")
        said = self._read_body()
        asked = f"{self._scope['method']} {self._scope['path']}" + (f"?{query}" if query else "")
        if UNCONFIRMED in self._scope:
            asked = f"not confirmed: {asked}"
        return f"{asked} {json.dumps(said, ensure_ascii=False)}" if said else asked

    def _read_body(self) -> dict[str, Any]:
        if not self._body or len(self._body) > BODY_BYTES:
            return {}
        try:
            said = json.loads(self._body)
        except (ValueError, RecursionError):
            return {}
        return {key: one for key, one in said.items() if key not in SECRETS} if isinstance(said, dict) else {}


def caller_of(scope: Scope) -> Identity | None:
    """The identity that the sign-in check has found, if it has."""
    identity = scope.get(IDENTITY)
    return identity if isinstance(identity, Identity) else None


def address_of(scope: Scope) -> str:
    """The address that asks; empty where the server does not know it."""
    client = scope.get("client")
    return str(client[0]) if client else ""


def _outcome(status: int) -> Outcome:
    if 200 <= status < 400:
        return "done"
    return "refused" if status in REFUSED else "failed"
