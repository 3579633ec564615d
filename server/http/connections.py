"""Limits of connections: their number, in all and of each address, and the time for a client's request.

A client that is let wait costs a file handle, and the server has only so many: silent connections of a
stranger would keep everybody else from STOP.
"""

import asyncio
import resource
from collections import Counter
from collections.abc import Iterator, Sequence
from ipaddress import ip_address
from ssl import SSLContext
from typing import Any, Protocol

from h11 import Request
from uvicorn.protocols.http.h11_impl import H11Protocol

from robot_runtime.clock import Clock
from server.platform.reverse_proxy import Network

HEAD_SECONDS = 10.0
"""From the connection, or the first byte of a further request, to the end of the request's head."""
BODY_SECONDS = 30.0
"""Of patience with a body, which its bytes renew: an upload lasts as long as it progresses."""
BODY_BYTES_PER_S = 1000.0
"""The least mean speed of a body that lasts longer than that."""
CONNECTIONS_MAX = 400
ADDRESS_MAX = 100
"""Connections of one address. A page keeps six open at most."""
FILES_MAX = 16_384


class LimitedConnection(Protocol):
    """A connection that `Connections` counts; `progress` is when its client last sent something."""

    progress: float

    @property
    def waits(self) -> bool:
        """True while the client's request is incomplete, so that no work is done for it."""

    def overdue(self, now: float) -> bool:
        """Return True where the client has taken too long."""

    def end(self) -> None:
        """End the connection."""


class Connections:
    """The open HTTP connections, from accept on; live sockets leave it and have limits of their own
    (`server.stream.hub`).
    """

    def __init__(self, clock: Clock, total: int = CONNECTIONS_MAX, proxies: Sequence[Network] = ()) -> None:
        self._clock = clock
        self._total = total
        self._proxies = proxies
        self._open: dict[LimitedConnection, str] = {}
        self._of: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._open)

    def __iter__(self) -> Iterator["LimitedConnection"]:
        return iter(self._open)

    def now(self) -> float:
        """Return the steady time, in s."""
        return self._clock.now()

    def add(self, connection: "LimitedConnection", address: str) -> bool:
        """Admit a connection; return False where there are too many already.

        A connection that waits for its client makes room: a complete request always comes before silence.
        """
        self._open[connection] = address
        self._of[address] += 1
        if self._of[address] > ADDRESS_MAX and not self._is_proxy(address):
            return self._make_room(connection, address)
        if len(self._open) > self._total:
            (most, _), *_ = self._of.most_common(1)
            return self._make_room(connection, most)
        return True

    def remove(self, connection: "LimitedConnection") -> None:
        """Remove a connection, if it is there."""
        address = self._open.pop(connection, None)
        if address is not None:
            self._of[address] -= 1
            if not self._of[address]:
                del self._of[address]

    def expire(self) -> None:
        """End the connections whose client has taken too long."""
        now = self.now()
        for connection in [candidate for candidate in self if candidate.overdue(now)]:
            connection.end()

    def _is_proxy(self, address: str) -> bool:
        """Return True for a trusted proxy, whose connections are of many clients (`server.http.proxies`)."""
        if not self._proxies or not address:
            return False
        peer = ip_address(address)
        return any(peer in network for network in self._proxies)

    def _make_room(self, new: "LimitedConnection", address: str) -> bool:
        waiting = [
            candidate
            for candidate, whose in self._open.items()
            if whose == address and candidate is not new and candidate.waits
        ]
        if not waiting:
            self.remove(new)
            return False
        min(waiting, key=lambda connection: connection.progress).end()
        return True


class HttpProtocol(H11Protocol):
    """uvicorn's HTTP connection, within the limits of `connections`."""

    def __init__(self, connections: Connections, **options: Any) -> None:
        super().__init__(**options)
        self._limits = connections
        self._head_began: float | None = None
        self.progress = connections.now()
        self._body_until = 0.0
        self._made = False
        self._early = b""
        """Bytes that arrived before `connection_made`, as TLS may let them."""

    @property
    def waits(self) -> bool:
        """True while the client's request is incomplete, so that no work is done for it."""
        return self._is_between or self._is_in_body

    def overdue(self, now: float) -> bool:
        """Return True where the client has taken too long for a head or a body."""
        if self._is_between:
            return self._head_began is not None and now - self._head_began >= HEAD_SECONDS
        if self._is_in_body and self.flow.read_paused:
            # The client waits for the server.
            self._body_until = now + BODY_SECONDS
        return self._is_in_body and now >= self._body_until

    def end(self) -> None:
        """End the connection."""
        self._limits.remove(self)
        self.transport.abort()

    def connection_made(self, transport: Any) -> None:
        """Take a new connection, or refuse it."""
        self._made = True
        # With TLS, the handshake had a time of its own.
        self._head_began = self.progress = self._limits.now()
        super().connection_made(transport)
        if not self._limits.add(self, address_of_peer(transport)):
            transport.abort()
        elif self._early:
            self.data_received(self._early)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._limits.remove(self)
        if self._made:
            super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take the client's bytes."""
        if not self._made:
            self._early += data
            return
        self.progress = now = self._limits.now()
        if self._is_between and self._head_began is None:
            self._head_began = now
        began_in_body = self._is_in_body
        super().data_received(data)
        if not self._is_between:
            self._head_began = None
        if began_in_body:
            self._body_until = min(self._body_until + len(data) / BODY_BYTES_PER_S, now + BODY_SECONDS)
        else:
            self._body_until = now + BODY_SECONDS

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


class TlsHandshake(asyncio.Protocol):
    """A connection up to the end of its TLS handshake; then `protocol` takes it over.

    asyncio would make the protocol of a connection only then, too late to count it.
    """

    def __init__(self, connections: Connections, tls: SSLContext, protocol: HttpProtocol) -> None:
        self._limits = connections
        self._tls = tls
        self._protocol = protocol
        self._transport: Any = None
        self._task: asyncio.Task[None] | None = None
        self.waits = True
        self.progress = connections.now()

    def overdue(self, now: float) -> bool:
        """Return True where the handshake has taken too long."""
        return now - self.progress >= HEAD_SECONDS

    def end(self) -> None:
        """End the connection."""
        self._limits.remove(self)
        self._transport.abort()

    def connection_made(self, transport: Any) -> None:
        """Begin the handshake, or refuse the connection."""
        self._transport = transport
        transport.pause_reading()
        if self._limits.add(self, address_of_peer(transport)):
            self._task = asyncio.create_task(self._shake_hands())
        else:
            transport.abort()

    async def _shake_hands(self) -> None:
        loop = asyncio.get_running_loop()
        try:
            encrypted = await loop.start_tls(self._transport, self._protocol, self._tls, server_side=True)
        except OSError:
            return
        finally:
            self._limits.remove(self)
        if encrypted is not None and not encrypted.is_closing():
            self._protocol.connection_made(encrypted)


def address_of_peer(transport: asyncio.BaseTransport) -> str:
    """Return the address at the other end of a connection; empty where it is not known."""
    peer = transport.get_extra_info("peername")
    return str(peer[0]) if peer else ""


def raise_file_limit() -> int:
    """Raise the number of files that this process may open, up to `FILES_MAX`; return the new limit."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    raised = FILES_MAX if hard == resource.RLIM_INFINITY else min(hard, FILES_MAX)
    if soft != resource.RLIM_INFINITY and soft < raised:
        resource.setrlimit(resource.RLIMIT_NOFILE, (raised, hard))
        return raised
    return soft
