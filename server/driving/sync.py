"""The sender of the control lease's epoch to the runtime, which then drops earlier holders' commands."""

import asyncio
import logging
from collections.abc import Awaitable, Callable

from robot_runtime.errors import RefusedError
from server.stream.bridge import RuntimeSilentError

log = logging.getLogger(__name__)

TRY_AGAIN_SECONDS = 0.5


class LeaseSync:
    """The calls of `ask(epoch)` at each change, and for every run of the runtime, until it has answered."""

    def __init__(self, ask: Callable[[int], Awaitable[None]]) -> None:
        self._ask = ask
        self._target = ("", 0)
        self._news = asyncio.Event()

    def see_run(self, run: str) -> None:
        """Store the present run of the runtime."""
        self._set_target(run, self._target[1])

    def see_epoch(self, epoch: int) -> None:
        """Store the epoch in force."""
        self._set_target(self._target[0], epoch)

    async def run(self) -> None:
        """Send each new epoch, for ever."""
        while True:
            await self._news.wait()
            self._news.clear()
            try:
                await self._ask(self._target[1])
            except RuntimeSilentError:
                await asyncio.sleep(TRY_AGAIN_SECONDS)
                self._news.set()
            except RefusedError as problem:
                log.error("the runtime does not take the control's epoch: %s", problem)

    def _set_target(self, run: str, epoch: int) -> None:
        if (run, epoch) != self._target:
            self._target = run, epoch
            self._news.set()
