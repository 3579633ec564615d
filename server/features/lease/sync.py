"""Tells the runtime which epoch of the control counts, so that it too drops what earlier drivers sent."""

import asyncio
import logging
from collections.abc import Awaitable, Callable

from robot_runtime.errors import Refused
from server.stream.bridge import RuntimeSilent

log = logging.getLogger(__name__)

TRY_AGAIN_SECONDS = 0.5


class Telling:
    """Asks with `ask(epoch)`, at each change, and once of every run of the runtime, until it has answered."""

    def __init__(self, ask: Callable[[int], Awaitable[None]]) -> None:
        self._ask = ask
        self._wanted = ("", 0)
        self._news = asyncio.Event()

    def see_run(self, run: str) -> None:
        """This run of the runtime speaks now."""
        self._want(run, self._wanted[1])

    def see_epoch(self, epoch: int) -> None:
        """This is the epoch now."""
        self._want(self._wanted[0], epoch)

    async def run(self) -> None:
        """Tell, for ever."""
        while True:
            await self._news.wait()
            self._news.clear()
            try:
                await self._ask(self._wanted[1])
            except RuntimeSilent:
                await asyncio.sleep(TRY_AGAIN_SECONDS)
                self._news.set()
            except Refused as problem:
                log.error("the runtime does not take the control's epoch: %s", problem)

    def _want(self, run: str, epoch: int) -> None:
        if (run, epoch) != self._wanted:
            self._wanted = run, epoch
            self._news.set()
