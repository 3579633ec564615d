"""The end of a live socket: with a reason, or with the token that opened it."""

import asyncio
from collections.abc import Awaitable

from fastapi import WebSocket, WebSocketDisconnect

from server.http.security import POLICY_VIOLATION
from server.stream.hub import EvictedError

CLOSE_SECONDS = 1.0


async def close_with_reason(socket: WebSocket, reason: EvictedError) -> None:
    """Close a socket with this reason.

    A client that does not read misses the reason, too; the kernel then ends the connection.
    """
    try:
        async with asyncio.timeout(CLOSE_SECONDS):
            await socket.close(reason.code, str(reason))
    except (TimeoutError, WebSocketDisconnect, RuntimeError):
        return


async def end_after(seconds: float | None, serving: Awaitable[None]) -> None:
    """Serve until the client leaves. Raise EvictedError when its token ends, after these seconds."""
    try:
        async with asyncio.timeout(seconds) as limit:
            await serving
    except TimeoutError:
        if not limit.expired():
            raise
        raise EvictedError("This token has ended.", POLICY_VIOLATION) from None
