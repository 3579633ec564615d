"""Messages to systemd, where it has started this process: ready, waiting, alive (sd_notify(3))."""

import os
import socket
from contextlib import suppress

FEED_SECONDS = 1.0


class ServiceManager:
    """The connection to systemd; without $NOTIFY_SOCKET it sends nothing. Times are s of any steady clock."""

    def __init__(self) -> None:
        address = os.environ.get("NOTIFY_SOCKET", "")
        # A leading @ stands for the zero byte of Linux's abstract sockets.
        self._address = "\0" + address[1:] if address.startswith("@") else address
        period = os.environ.get("WATCHDOG_USEC", "")
        self._watch = f"\nWATCHDOG_USEC={period}" if period else ""
        self._fed = float("-inf")

    def ready(self) -> None:
        """Tell it that the service has started, and is watched from now on."""
        self._send(f"READY=1{self._watch}".encode())

    def feed(self, now: float) -> None:
        """Tell its watchdog that the service is alive; at most once a second, however often it is called."""
        if now - self._fed >= FEED_SECONDS:
            self._fed = now
            self._send(b"WATCHDOG=1")

    def wait(self, seconds: float) -> None:
        """Tell it that the service waits for others, and starts within so many s after that."""
        watch = f"\nWATCHDOG_USEC={round(seconds * 1e6)}\nWATCHDOG=1" if self._watch else ""
        self._send(f"READY=1{watch}".encode())

    def _send(self, message: bytes) -> None:
        if not self._address:
            return
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as line:
            line.setblocking(False)
            # A full queue or a systemd that restarts must not stop the control loop.
            with suppress(OSError):
                line.sendto(message, self._address)
