"""Turns of requests: a few at a time for a viewer's device; without memory, only those for the robot.

Each request that is under way costs the event loop time, and memory until its answer is read. A viewer may
open a hundred connections, and read nothing.
"""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from server.http.dependencies import find_service
from server.http.security import refuse
from server.http.sign_in.identity import IDENTITY, Identity
from server.platform.memory_reserve import SHORT, MemoryReserve

REQUESTS_AT_ONCE = 6
"""Of one viewer's device; a browser has as many."""
STOPS_AT_ONCE = 2
"""Besides, so that other requests keep no STOP waiting."""
STOP_PATHS = ("/api/robot/stop", "/api/robots/stop")
"""STOP of a robot, and of all robots of a lab."""
OPERATING = ("/api/robot", "/api/robots", "/api/control", "/api/alive", "/api/health", "/api/access/me")
"""Paths, and beginnings of paths, that are served where memory is short, as the page's own files are."""


class RequestTurns:
    """ASGI middleware: lets a viewer's requests wait for their turn, and refuses requests without memory."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._turns: dict[tuple[int, int], asyncio.Semaphore] = {}
        self._waiting: Counter[tuple[int, int]] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse."""
        caller = scope.get(IDENTITY)
        if not isinstance(caller, Identity):
            await self._app(scope, receive, send)
            return
        if _can_wait(scope, caller) and find_service(HTTPConnection(scope), MemoryReserve).short:
            await refuse(scope, receive, send, 503, SHORT)
        elif scope["type"] == "http" and caller.role != "operator":
            at_once = STOPS_AT_ONCE if scope["path"] in STOP_PATHS else REQUESTS_AT_ONCE
            async with self._turn(caller.device, at_once):
                await self._app(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    @asynccontextmanager
    async def _turn(self, device: int, at_once: int) -> AsyncIterator[None]:
        key = device, at_once
        if key not in self._turns:
            self._turns[key] = asyncio.Semaphore(at_once)
        self._waiting[key] += 1
        try:
            async with self._turns[key]:
                yield
        finally:
            self._waiting[key] -= 1
            if not self._waiting[key]:
                del self._waiting[key], self._turns[key]


def _can_wait(scope: Scope, caller: Identity) -> bool:
    """Return True for a request that does not operate the robot."""
    if scope["type"] == "websocket":
        return caller.role != "operator"
    path = scope["path"]
    operates = any(path == prefix or path.startswith(f"{prefix}/") for prefix in OPERATING)
    return path.startswith("/api/") and not operates
