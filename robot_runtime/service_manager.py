"""Messages to systemd, where it has started this process: ready, alive, still starting (sd_notify(3))."""

import os
import socket
from contextlib import suppress

FEED_SECONDS = 1.0


class ServiceManager:
    """systemd, or nobody: without $NOTIFY_SOCKET nothing is sent. The times are of any steady clock, in s."""

    def __init__(self) -> None:
        address = os.environ.get("NOTIFY_SOCKET", "")
        # A leading @ stands for the zero byte of Linux's abstract sockets.
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._fed = float("-inf")

    def ready(self) -> None:
        """Tell it that the service has started."""
        self._send(b"READY=1")

    def feed(self, now: float) -> None:
        """Tell its watchdog that the service is alive; at most once a second, however often it is called."""
        if now - self._fed >= FEED_SECONDS:
            self._fed = now
            self._send(b"WATCHDOG=1")

    def still_starting(self, seconds: float) -> None:
        """Ask it to wait for another so many seconds for the service's start."""
        self._send(f"EXTEND_TIMEOUT_USEC={round(seconds * 1e6)}".encode())

    def _send(self, message: bytes) -> None:
        if not self._address:
            return
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as line:
            line.setblocking(False)
            # A full queue or a systemd that restarts must not stop the control loop.
            with suppress(OSError):
                line.sendto(message, self._address)
