"""Viewers that need little processor time, so that many of them do not disturb the measurement."""

import select
import socket
import threading
from collections.abc import Callable, Iterator
from time import monotonic
from types import TracebackType
from typing import Self

from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.uri import parse_uri

from bench.hub_ends import TOPICS
from robot_runtime.contract.topics import BY_NAME, ROW_BYTES, TIME
from robot_runtime.transport.blocks import HEADER

_TIMEOUT = 20.0
_DRAIN_EVERY = 0.05
_PING = b"\x89\x04"
"""The beginning of a server's ping with the four bytes that websockets puts into it (RFC 6455, 5.2)."""
_PING_BYTES = 6
_TOPICS = {BY_NAME[name].id for name in TOPICS}

Times = Callable[[str | bytes], list[float]]
"""When the samples in a message were made (s, steady clock)."""


def OURS(message: str | bytes) -> list[float]:  # noqa: N802 - one of two
    """Yield each sample of blocks, one after the other."""
    times: list[float] = []
    if isinstance(message, str):
        return times
    at = 0
    while at < len(message):
        topic, _, count, _, size = HEADER.unpack_from(message, at)
        at += HEADER.size
        if topic in _TOPICS:
            step = ROW_BYTES[topic]
            times += [TIME.unpack_from(message, at + row * step)[0] for row in range(count)]
        at += size
    return times


def THEIRS(message: str | bytes) -> list[float]:  # noqa: N802 - one of two
    """Yield a sample of foxglove.sdk.v1: opcode, subscription (u32), time of logging (u64), payload."""
    if isinstance(message, str) or message[0] != 1:
        return []
    return [TIME.unpack_from(message, 13)[0]]


class TimedViewer:
    """One WebSocket. Raises OSError where it cannot be opened."""

    def __init__(
        self, url: str, times: Times, headers: dict[str, str], receive_bytes: int | None = None
    ) -> None:
        self.times = times
        uri = parse_uri(url)
        self.socket = socket.create_connection((uri.host, uri.port), _TIMEOUT)
        if receive_bytes is not None:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
        self._protocol = ClientProtocol(uri, max_size=None)
        request = self._protocol.connect()
        for name, value in headers.items():
            request.headers[name] = value
        if "sec-websocket-protocol" in headers:
            self._protocol.available_subprotocols = [headers["sec-websocket-protocol"]]  # type: ignore[list-item]
        self._protocol.send_request(request)
        self._flush()
        self._ready: list[str | bytes] = []
        while self._protocol.state is State.CONNECTING:
            self._receive()
            if self._protocol.handshake_exc is not None:
                raise OSError(f"{url} cannot be opened: {self._protocol.handshake_exc}")

    def messages(self) -> Iterator[str | bytes]:
        """Yield the messages until none comes any more."""
        while True:
            while self._ready:
                yield self._ready.pop(0)
            try:
                if not self._receive():
                    return
            except OSError:
                return

    def send(self, text: str) -> None:
        """Send a text."""
        self._protocol.send_text(text.encode())
        self._flush()

    def answer_pings(self, data: bytes) -> None:
        """Answer the pings in raw bytes of the socket: whoever answers none is sent away.

        A sample that looks like one is answered as well, which the server ignores.
        """
        at = data.find(_PING)
        while 0 <= at <= len(data) - _PING_BYTES:
            self._protocol.send_pong(data[at + len(_PING) : at + _PING_BYTES])
            at = data.find(_PING, at + 1)
        self._flush()

    def close(self) -> None:
        """Close the viewer; whoever waits for its messages gets no more."""
        self.socket.close()

    def _receive(self) -> bool:
        data = self.socket.recv(1 << 20)
        if not data:
            raise ConnectionError("the other end has closed")
        self._protocol.receive_data(data)
        for event in self._protocol.events_received():
            if not isinstance(event, Frame):
                continue
            data = bytes(event.data)
            if event.opcode is Opcode.TEXT:
                self._ready.append(data.decode())
            elif event.opcode is Opcode.BINARY:
                self._ready.append(data)
        self._flush()
        return self._protocol.state is State.OPEN

    def _flush(self) -> None:
        for data in self._protocol.data_to_send():
            self.socket.sendall(data)


class TimedReading:
    """A viewer that is timed."""

    def __init__(self, viewer: TimedViewer) -> None:
        self._viewer = viewer
        self._samples = self._bytes = 0
        self._latencies: list[float] = []
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._viewer.socket.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._viewer.close()

    def begin(self) -> None:
        """Count from now on."""
        self._samples, self._bytes, self._latencies = 0, 0, []

    def end(self) -> tuple[int, int, list[float]]:
        """Return the samples since `begin`, their bytes, and each one's delay, s."""
        return self._samples, self._bytes, self._latencies

    def _run(self) -> None:
        for message in self._viewer.messages():
            now = monotonic()
            times = self._viewer.times(message)
            if not times:
                continue
            self._samples += len(times)
            self._bytes += len(message) + (2 if len(message) < 126 else 4)
            self._latencies += [now - time for time in times]


class Drain:
    """Viewers that are read now and then, each time to the end; only the bytes are counted.

    Who is not read from the beginning is sent away: each is read while the next are opened.
    """

    def __init__(self, open_one: Callable[[], TimedViewer], many: int) -> None:
        self.bytes = 0
        self._sent_away = False
        self._open_one, self._many = open_one, many
        self._viewers: list[TimedViewer] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        for _ in range(self._many):
            self._viewers.append(self._open_one())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()
        for viewer in self._viewers:
            viewer.close()

    def check(self) -> None:
        """Raise ConnectionError where a viewer was disconnected."""
        if self._sent_away:
            raise ConnectionError("a viewer was sent away; is the computer too busy?")

    def _run(self) -> None:
        ends = dict[socket.socket, bytes]()
        while not self._ended.wait(_DRAIN_EVERY):
            viewers = {viewer.socket: viewer for viewer in self._viewers}
            for ready in select.select(viewers, [], [], 0)[0]:
                try:
                    data = ready.recv(1 << 20)
                except ConnectionError:
                    data = b""
                if not data:
                    self._sent_away = True
                    return
                self.bytes += len(data)
                # A ping may be cut in two.
                viewers[ready].answer_pings(ends.get(ready, b"") + data)
                ends[ready] = data[1 - _PING_BYTES :]
