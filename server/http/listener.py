"""The listening socket. It needs none of the web server's libraries."""

import socket

from server.platform.settings import SetupError

SEND_BUFFER_BYTES = 65_536
"""Small: with the kernel's default of megabytes, a client that stopped reading goes unnoticed for minutes."""
USER_TIMEOUT_MS = 180_000
"""The kernel ends a connection whose data nobody has taken for this long. A client that reads 1 kB a second
takes none for two minutes, until its kernel has room for a whole segment of the loopback again.
"""
BACKLOG = 128
"""Clients that may wait while the server restarts."""


def open_socket(host: str, port: int) -> socket.socket:
    """Return a listening socket whose connections inherit its limits.

    Raise SetupError where it cannot be opened.
    """
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
