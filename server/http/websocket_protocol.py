"""The WebSocket protocol of the server: binary messages are framed directly, which costs less CPU.

What is read from a socket at once holds thousands of small messages. They are taken in pieces, each after the
messages of the one before, with a turn for everybody else after each message.
"""

import asyncio
from struct import Struct
from typing import TYPE_CHECKING, Any

from uvicorn.protocols.utils import ClientDisconnected
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame
from websockets.protocol import State

if TYPE_CHECKING:
    from uvicorn._types import ASGISendEvent

BINARY = "mucat.binary"
"""An extension of ASGI's scope: its `send` sends a binary message past the layers of the application, which
costs less than half. It raises OSError where the client has gone. Its `offer` sends a `binary_frame` at once,
and returns False where it would have to wait or the client has gone: it costs no turn of the event loop."""
PIECE_BYTES = 1024
UNREAD_MAX = 262_144
"""Bytes that wait in this process for a client that reads nothing, until it is disconnected: answers to its
own pings, for whose sending nobody waits."""
PARTS_MAX = 100
"""Frames of one message."""
FLUSH_SECONDS = 10.0
"""For which what waits for a client may still be sent after the end of its socket."""
_BINARY = 0x82
"""First byte of an unfragmented binary frame (RFC 6455, 5.2)."""
_SHORT, _LONG = 125, 0xFFFF
_HEAD, _HEAD_16, _HEAD_64 = Struct(">BB"), Struct(">BBH"), Struct(">BBQ")


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """uvicorn's protocol; binary messages bypass websockets' framing, which costs more than the system's
    send.

    It holds as long as nothing is compressed: `server.http.serving` turns that off.
    """

    def __init__(self, *options: Any, **more: Any) -> None:
        super().__init__(*options, **more)
        self._received = bytearray()
        """Bytes that wait until the messages before them were taken; meanwhile no more are read."""

    def data_received(self, data: bytes) -> None:
        """Take the client's bytes, piece by piece."""
        self._received += data
        if not self.read_paused:
            self._take_piece()

    def handle_ping(self) -> None:
        """Answer a ping of the client, unless it reads no answers."""
        if self.transport.get_write_buffer_size() > UNREAD_MAX:
            self.transport.abort()
            return
        super().handle_ping()

    def handle_cont(self, event: Frame) -> None:
        """Take a further part of a message. Parts without content would have no end, and no size."""
        if len(self.frames) >= PARTS_MAX:
            self.transport.abort()
            return
        super().handle_cont(event)

    async def receive(self) -> Any:
        """Return the next message for the application."""
        message = await self.queue.get()
        if self.queue.empty():
            self._go_on()
        # A queue that is not empty would give one message after the other, without a turn for others.
        await asyncio.sleep(0)
        return message

    def _take_piece(self) -> None:
        piece = bytes(self._received[:PIECE_BYTES])
        del self._received[:PIECE_BYTES]
        super().data_received(piece)
        # Nobody takes what comes after the end of the application.
        if self.queue.empty() or self.close_sent:
            self._go_on()
        elif self._received:
            self._pause_reading(paused=True)

    def _go_on(self) -> None:
        """Take the next piece soon, or read on after the last one."""
        if self.transport.is_closing():
            return
        self._pause_reading(paused=bool(self._received))
        if self._received:
            self.loop.call_soon(self._take_piece)

    def _pause_reading(self, *, paused: bool) -> None:
        if paused != self.read_paused:
            self.read_paused = paused
            (self.transport.pause_reading if paused else self.transport.resume_reading)()

    async def run_asgi(self) -> None:
        """Run the application, which may send binary messages directly."""
        extensions: Any = self.scope["extensions"]
        extensions[BINARY] = {"send": self.send_binary, "offer": self.offer}
        await super().run_asgi()
        if not self.disconnected:
            self.loop.call_later(FLUSH_SECONDS, self.transport.abort)

    async def send(self, message: "ASGISendEvent") -> None:
        """Send a message of the application."""
        event: Any = message
        data = event.get("bytes")
        if data is None:
            await super().send(message)
        else:
            await self.send_binary(data)

    async def send_binary(self, data: bytes) -> None:
        """Send a binary message. Raise OSError where the client has gone."""
        if not self.writable.is_set():
            await self.writable.wait()
        if self.disconnected or self.conn.state is not State.OPEN:
            raise ClientDisconnected
        self.transport.write(binary_frame(data))

    def offer(self, frame: bytes) -> bool:
        """Send a frame if the client can take it now; return True where it was sent."""
        if not self.writable.is_set() or self.disconnected or self.conn.state is not State.OPEN:
            return False
        self.transport.write(frame)
        return True

    def shutdown(self) -> None:
        """Close the connection as the server ends.

        uvicorn's own raises InvalidState where the client has closed it and not read everything yet, and the
        server then ends without its lifespan.
        """
        if self.handshake_complete and not self.close_sent and self.conn.state is not State.OPEN:
            self.stop_keepalive()
            self.transport.close()
        else:
            super().shutdown()


def binary_frame(data: bytes) -> bytes:
    """Return an unmasked frame with this binary message, the same for all clients."""
    size = len(data)
    if size <= _SHORT:
        return _HEAD.pack(_BINARY, size) + data
    if size <= _LONG:
        return _HEAD_16.pack(_BINARY, _SHORT + 1, size) + data
    return _HEAD_64.pack(_BINARY, _SHORT + 2, size) + data
