"""The web server around the application."""

import asyncio
import errno
import logging
import socket
import sys
from asyncio.selector_events import _SelectorSocketTransport  # type: ignore[attr-defined]
from asyncio.sslproto import SSLProtocol
from collections.abc import Sequence
from typing import Any

import uvicorn
from fastapi import FastAPI
from uvicorn.config import STARTUP_FAILURE

from robot_runtime.clock import SteadyClock
from server.http.connections import (
    CONNECTIONS_MAX,
    Connections,
    HttpProtocol,
    TlsHandshake,
    raise_file_limit,
)
from server.http.listener import BACKLOG
from server.http.websocket_protocol import WebSocketProtocol
from server.platform.certificate import Certificate
from server.platform.reverse_proxy import Network

log = logging.getLogger(__name__)

OUT_OF_FILES = frozenset({errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM})
REPORT_SECONDS = 60.0
TICK_SECONDS = 0.25
"""s between two looks at the connections, and at whether the server shall end."""
READ_BYTES = 32_768
MESSAGE_BYTES_MAX = 4096
HEAD_BYTES_MAX = 16_384
GRACE_SECONDS = 3
KEEP_ALIVE_SECONDS = 60
"""The time for which an idle connection stays open. It is longer than the 5 s that are usual in programs: the
program closes the connection first, and no request meets a reset.
"""
PING_SECONDS, PONG_SECONDS = 5.0, 10.0
"""s between two pings of a live socket, and until the answer. A page whose radio is gone, as under water,
closes nothing: without these it would count as watching for as long as TCP tries.
"""


class WebServer(uvicorn.Server):
    """uvicorn's server, which ends connections whose clients take too long."""

    def __init__(self, config: uvicorn.Config, connections: Connections) -> None:
        super().__init__(config)
        self.connections = connections

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start the application, then accept connections."""
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(OutOfFiles(self.connections).report)
        _limit_reads()
        await self.lifespan.startup()
        if self.lifespan.should_exit:
            sys.exit(STARTUP_FAILURE)

        def make_protocol() -> asyncio.Protocol:
            state, options = self.server_state, {"config": self.config, "app_state": self.lifespan.state}
            protocol = HttpProtocol(self.connections, server_state=state, **options)
            tls = self.config.ssl
            return protocol if tls is None else TlsHandshake(self.connections, tls, protocol)

        self.servers = [
            await loop.create_server(make_protocol, sock=socket, backlog=BACKLOG) for socket in sockets or []
        ]
        self.started = True

    async def main_loop(self) -> None:
        """Tick until the server is told to end; uvicorn's own loop wakes ten times a second."""
        while not await self.on_tick(0):
            await asyncio.sleep(TICK_SECONDS)

    async def on_tick(self, counter: int) -> bool:
        """Check the connections; return True where the server is to end."""
        self.connections.expire()
        return await super().on_tick(counter)


class OutOfFiles:
    """Reports of connections that cannot be accepted for want of file handles, once a minute.

    asyncio reports it each second for each place in the backlog (python/cpython#151615).
    """

    def __init__(self, connections: Connections) -> None:
        self._connections = connections
        self._reported: float | None = None

    def report(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Handle an exception of the event loop."""
        problem = context.get("exception")
        if not isinstance(problem, OSError) or problem.errno not in OUT_OF_FILES:
            loop.default_exception_handler(context)
            return
        now = self._connections.now()
        if self._reported is None or now - self._reported >= REPORT_SECONDS:
            self._reported = now
            log.error(
                "No connection can be accepted: %s. %d are open.", problem.strerror, len(self._connections)
            )


def _limit_reads() -> None:
    """Limit a read of the event loop to less than asyncio's quarter of a megabyte.

    Each connection may hold as much, TLS as much again from its beginning on. A piece of this size comes from
    the memory that the process has already, so that a STOP is read also where the system gives it no more.
    """
    for kind in (_SelectorSocketTransport, SSLProtocol):
        kind.max_size = READ_BYTES


def make_server(
    app: FastAPI, certificate: Certificate | None = None, proxies: Sequence[Network] = ()
) -> WebServer:
    """Return a server for the application, with TLS where it has a certificate; it compresses no messages.

    X-Forwarded-For counts from these proxies alone: the client is the last address in it that is
    none of them.
    """
    files = raise_file_limit()
    connections = Connections(SteadyClock(), min(CONNECTIONS_MAX, files // 2), proxies)
    config = uvicorn.Config(
        app,
        ssl_certfile=None if certificate is None else certificate.file,
        ssl_keyfile=None if certificate is None else certificate.key,
        ws=WebSocketProtocol,
        loop="asyncio",
        lifespan="on",
        log_level="warning",
        access_log=False,
        proxy_headers=bool(proxies),
        forwarded_allow_ips=[str(proxy) for proxy in proxies],
        server_header=False,
        ws_per_message_deflate=False,
        ws_max_size=MESSAGE_BYTES_MAX,
        ws_ping_interval=PING_SECONDS,
        ws_ping_timeout=PONG_SECONDS,
        h11_max_incomplete_event_size=HEAD_BYTES_MAX,
        timeout_graceful_shutdown=GRACE_SECONDS,
        timeout_keep_alive=KEEP_ALIVE_SECONDS,
    )
    return WebServer(config, connections)
