"""A page on a poor connection: it reads too slowly, and counts the reported losses."""

import json
import socket
import threading
from collections import Counter
from contextlib import suppress

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from robot_runtime.contract.topics import Kind
from robot_runtime.transport.blocks import read_blocks
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import Stack

PAUSE = 0.4
"""s between two messages; the robot sends some 25 a second."""
READ_AHEAD = 4096
"""bytes"""
STALL = 30.0
"""s for which a page that has stopped reading keeps its connection, if it may."""


class SlowPage:
    """Reads slowly; if `stalled` not at all. Reconnects whenever it is disconnected."""

    def __init__(self, stack: Stack, *, stalled: bool) -> None:
        self.received: Counter[str] = Counter()
        """Samples that the server said it left out, by topic, ..."""
        self.missing: Counter[str] = Counter()
        """... and those that the numbers show to be missing."""
        self._stack = stack
        self._stalled = stalled
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._come_back, name="slow page")
        self._thread.start()

    def close(self) -> None:
        """Disconnect for good."""
        self._ending.set()
        self._thread.join()

    def _come_back(self) -> None:
        while not self._ending.is_set():
            with suppress(OSError, WebSocketException, TimeoutError):
                self._read()
            self._ending.wait(0.1)

    def _read(self) -> None:
        address = f"ws://127.0.0.1:{self._stack.port}/api/live"
        signed = shell_headers(DataFolder(self._stack.data))
        origin = Origin(self._stack.url)
        # Else the system would read ahead for minutes.
        line = socket.socket()
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, READ_AHEAD)
        line.connect(("127.0.0.1", self._stack.port))
        with connect(
            address,
            sock=line,
            origin=origin,
            max_size=None,
            max_queue=1,
            proxy=None,
            additional_headers=signed,
            close_timeout=0.2,
            ping_interval=None,
        ) as connection:
            if self._stalled:
                self._ending.wait(STALL)
                return
            expected: dict[str, int] = {}
            pending: Counter[str] = Counter()
            while not self._ending.wait(PAUSE):
                self._take(connection.recv(timeout=1.0), expected, pending)

    def _take(self, message: str | bytes, expected: dict[str, int], pending: Counter[str]) -> None:
        if isinstance(message, str):
            news = json.loads(message)
            if news["op"] == "dropped":
                pending[news["topic"]] += news["count"]
            return
        for block in read_blocks(message):
            name = block.topic.name
            # Of these only the newest is sent: what it replaces is not missing.
            if block.topic.kind is Kind.PICTURE or block.topic.newest_only:
                continue
            target = expected.get(name)
            # A smaller number: the sender was restarted, and losses are not known.
            if target is not None and block.first >= target:
                self.missing[name] += block.first - target
                self.received[name] += pending[name]
            del pending[name]
            expected[name] = block.following
