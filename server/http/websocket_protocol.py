"""The WebSocket protocol of the server: binary messages are framed directly, which costs less CPU."""

from struct import Struct
from typing import TYPE_CHECKING, Any

from uvicorn.protocols.utils import ClientDisconnected
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.protocol import State

if TYPE_CHECKING:
    from uvicorn._types import ASGISendEvent

BINARY = "mucat.binary"
"""An extension of ASGI's scope: its `send` sends a binary message past the layers of the application, which
costs less than half. It raises OSError where the client has gone."""
_BINARY = 0x82
"""First byte of an unfragmented binary frame (RFC 6455, 5.2)."""
_SHORT, _LONG = 125, 0xFFFF
_HEAD, _HEAD_16, _HEAD_64 = Struct(">BB"), Struct(">BBH"), Struct(">BBQ")


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """uvicorn's; binary messages go past websockets' own framing, which costs more than the system's send.

    It holds as long as nothing is compressed: `server.http.serving` turns that off.
    """

    async def run_asgi(self) -> None:
        """Run the application, which may send binary messages directly."""
        extensions: Any = self.scope["extensions"]
        extensions[BINARY] = {"send": self.send_binary}
        await super().run_asgi()

    async def send(self, message: "ASGISendEvent") -> None:
        """Send a message of the application."""
        event: Any = message
        data = event.get("bytes")
        if data is None:
            await super().send(message)
        else:
            await self.send_binary(data)

    async def send_binary(self, data: bytes) -> None:
        """Send a binary message. Raises OSError where the client has gone."""
        if not self.writable.is_set():
            await self.writable.wait()
        if self.disconnected or self.conn.state is not State.OPEN:
            raise ClientDisconnected
        self.transport.write(_head(len(data)) + data)

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


def _head(size: int) -> bytes:
    if size <= _SHORT:
        return _HEAD.pack(_BINARY, size)
    if size <= _LONG:
        return _HEAD_16.pack(_BINARY, _SHORT + 1, size)
    return _HEAD_64.pack(_BINARY, _SHORT + 2, size)
