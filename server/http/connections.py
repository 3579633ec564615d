"""Limits of connections: their number, in all and of each address, and the time a client may take to ask.

A client that is let wait costs a file handle, and the server has only so many: silent connections of a
stranger would keep everybody else from STOP.
"""

import resource
from collections import Counter
from collections.abc import Iterator
from typing import Any

from h11 import Request
from uvicorn.protocols.http.h11_impl import H11Protocol

from robot_runtime.clock import Clock

HEAD_SECONDS = 10.0
"""From the connection, or the first byte of a further request, to the end of the request's head."""
BODY_SECONDS = 30.0
"""Without a byte of a body; an upload lasts as long as it progresses."""
CONNECTIONS_MAX = 400
ADDRESS_MAX = 100
"""Connections of one address. A page keeps six open at most."""
FILES_MAX = 16_384


class Connections:
    """The open HTTP connections; live sockets leave it and have limits of their own (`server.stream.hub`)."""

    def __init__(self, clock: Clock, total: int = CONNECTIONS_MAX) -> None:
        self._clock = clock
        self._total = total
        self._open: dict[HttpProtocol, str] = {}
        self._of: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._open)

    def __iter__(self) -> Iterator["HttpProtocol"]:
        return iter(self._open)

    def now(self) -> float:
        """The steady time, in s."""
        return self._clock.now()

    def add(self, connection: "HttpProtocol", address: str) -> bool:
        """Admit a connection; False where there are too many already.

        One that waits for its client makes room: a request in full always comes before silence.
        """
        self._open[connection] = address
        self._of[address] += 1
        if self._of[address] > ADDRESS_MAX:
            return self._make_room(connection, address)
        if len(self._open) > self._total:
            (most, _), *_ = self._of.most_common(1)
            return self._make_room(connection, most)
        return True

    def remove(self, connection: "HttpProtocol") -> None:
        """Forget a connection, if it is there."""
        address = self._open.pop(connection, None)
        if address is not None:
            self._of[address] -= 1
            if not self._of[address]:
                del self._of[address]

    def expire(self) -> None:
        """End the connections whose client has taken too long."""
        now = self.now()
        for connection in [one for one in self if one.overdue(now)]:
            connection.end()

    def _make_room(self, new: "HttpProtocol", address: str) -> bool:
        waiting = [
            one for one, whose in self._open.items() if whose == address and one is not new and one.waits
        ]
        if not waiting:
            self.remove(new)
            return False
        min(waiting, key=lambda one: one.progress).end()
        return True


class HttpProtocol(H11Protocol):
    """uvicorn's HTTP connection, within the limits of `connections`."""

    def __init__(self, connections: Connections, **options: Any) -> None:
        super().__init__(**options)
        self._limits = connections
        self._head_began: float | None = connections.now()
        self.progress = connections.now()
        """When the client last sent something."""

    @property
    def waits(self) -> bool:
        """True where the client has not asked in full, so that nobody works for it."""
        return self._is_between or self._is_in_body

    def overdue(self, now: float) -> bool:
        """True where the client has taken too long for a head or a body."""
        if self._is_between:
            return self._head_began is not None and now - self._head_began >= HEAD_SECONDS
        return self._is_in_body and not self.flow.read_paused and now - self.progress >= BODY_SECONDS

    def end(self) -> None:
        """End the connection."""
        self._limits.remove(self)
        self.transport.abort()

    def connection_made(self, transport: Any) -> None:
        """Take a new connection, or refuse it."""
        super().connection_made(transport)
        if not self._limits.add(self, self.client[0] if self.client else ""):
            transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._limits.remove(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what the client has sent."""
        self.progress = self._limits.now()
        if self._is_between and self._head_began is None:
            self._head_began = self.progress
        super().data_received(data)
        if not self._is_between:
            self._head_began = None

    def handle_websocket_upgrade(self, event: Request) -> None:
        """Hand the connection to the WebSocket protocol."""
        self._limits.remove(self)
        super().handle_websocket_upgrade(event)

    @property
    def _is_between(self) -> bool:
        """True before a request's head is complete."""
        return self.cycle is None or self.cycle.response_complete

    @property
    def _is_in_body(self) -> bool:
        return not self._is_between and self.cycle.more_body


def raise_file_limit() -> int:
    """Raise the number of files that this process may open, up to `FILES_MAX`; returns the new limit."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    raised = FILES_MAX if hard == resource.RLIM_INFINITY else min(hard, FILES_MAX)
    if soft != resource.RLIM_INFINITY and soft < raised:
        resource.setrlimit(resource.RLIMIT_NOFILE, (raised, hard))
        return raised
    return soft
