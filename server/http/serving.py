"""The listening socket and the web server around the application."""

import socket

import uvicorn
from fastapi import FastAPI

from server.http.websocket_protocol import WebSocketProtocol
from server.platform.certificate import Certificate
from server.platform.settings import SetupError

SEND_BUFFER_BYTES = 65_536
"""Small: with the kernel's default of megabytes, a client that stopped reading goes unnoticed for minutes."""
USER_TIMEOUT_MS = 10_000
"""The kernel ends a connection whose data nobody has taken for this long."""
BACKLOG = 128
"""Clients that may wait while the server restarts."""
MESSAGE_BYTES_MAX = 4096
HEAD_BYTES_MAX = 16_384
GRACE_SECONDS = 3
KEEP_ALIVE_SECONDS = 60
"""The time for which an idle connection stays open. It is longer than the 5 s that are usual in programs: the
program closes the connection first, and no request meets a reset.
"""


def open_socket(host: str, port: int) -> socket.socket:
    """A listening socket whose connections inherit its limits. Raises SetupError where it cannot be had."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
    except OSError as problem:
        raise SetupError(
            f"{host} is no address of this computer: {problem.strerror}. Choose one with --host."
        ) from (problem)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, USER_TIMEOUT_MS)
        listener.bind(address)
        listener.listen(BACKLOG)
    except OSError as problem:
        listener.close()
        raise SetupError(
            f"Port {port} of {host} cannot be had: {problem.strerror}. "
            "End the program that uses it, or choose another with --port."
        ) from problem
    return listener


def make_server(app: FastAPI, certificate: Certificate | None = None) -> uvicorn.Server:
    """A server for the application, with TLS where it has a certificate; it takes nothing from
    X-Forwarded-*, and compresses no messages.
    """
    config = uvicorn.Config(
        app,
        ssl_certfile=None if certificate is None else certificate.file,
        ssl_keyfile=None if certificate is None else certificate.key,
        http="h11",
        ws=WebSocketProtocol,
        loop="asyncio",
        lifespan="on",
        log_level="warning",
        access_log=False,
        proxy_headers=False,
        server_header=False,
        ws_per_message_deflate=False,
        ws_max_size=MESSAGE_BYTES_MAX,
        h11_max_incomplete_event_size=HEAD_BYTES_MAX,
        timeout_graceful_shutdown=GRACE_SECONDS,
        timeout_keep_alive=KEEP_ALIVE_SECONDS,
    )
    return uvicorn.Server(config)
