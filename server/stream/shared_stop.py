"""STOPs share their way to the robot: waiting ones are merged, so that none delays another."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

AT_ONCE = 2
"""STOPs under way: one that the runtime does not answer lets the next one go at once."""
SPACING = 0.02
"""s from the beginning of a STOP to that of the next: each of them takes its share of the serial line."""

Answer = Mapping[str, Any]


class SharedStop:
    """STOPs sent by `send`, shared by all that wait.

    STOP is idempotent, so that all who wait get the answer of the same one. It begins after they asked:
    the robot may have been armed since the one before.
    """

    def __init__(self, send: Callable[[], Awaitable[Answer]]) -> None:
        self._send = send
        self._turns = asyncio.Semaphore(AT_ONCE)
        self._next: asyncio.Task[Answer] | None = None
        self._due = float("-inf")
        """When the next one may begin, by the event loop's clock."""

    async def ask(self) -> Answer:
        """Return the answer of a STOP that begins after this call. Raise as `send`."""
        if self._next is None:
            self._next = asyncio.create_task(self._begin())
        # It is carried out also where the one who asked has left.
        return await asyncio.shield(self._next)

    async def _begin(self) -> Answer:
        loop = asyncio.get_running_loop()
        try:
            async with self._turns:
                if (pause := self._due - loop.time()) > 0:
                    await asyncio.sleep(pause)
                self._due = loop.time() + SPACING
                # Whoever asks from now on waits for the next one.
                self._next = None
                return await self._send()
        finally:
            if self._next is asyncio.current_task():
                self._next = None
