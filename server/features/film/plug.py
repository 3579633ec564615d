"""The plug that has the camera filmed while a session is recorded."""

import asyncio
import logging
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any

from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.topics import STATE
from robot_runtime.errors import RefusedError
from server.feature import Plug
from server.features.film.choice import FilmChoice
from server.recording.recorder import Recorder
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.feed import Feed
from server.stream.hub import Hub

log = logging.getLogger(__name__)

LEASE_SECONDS = 60.0
"""s for which the robot films on without a server, whose next run stores the film."""
RENEWAL_SECONDS = 5.0
RETRY_SECONDS = 0.5
"""s until a runtime that did not answer, such as one that starts, is told again."""


class FilmPlug(Plug):
    """The plug that has a recording session filmed.

    It tells the runtime so at the session's begin, at changes, after a restart, and in between.
    """

    def __init__(self, choice: FilmChoice, recorder: Recorder, bridge: Bridge, hub: Hub, feed: Feed) -> None:
        self._choice = choice
        self._recorder = recorder
        self._bridge = bridge
        self._changed = asyncio.Event()
        self._recording = False
        self._filming = False
        self._informed_run = ""
        """The run of the runtime that was told last."""
        if not choice.refusal:
            choice.changed = self._changed.set
            hub.listeners.append(self._see)
            feed.listen(lambda _: self._see_run(), STATE)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Have sessions filmed as it is chosen."""
        return () if self._choice.refusal else (self._run(),)

    def _see(self, message: dict[str, Any]) -> None:
        if message["op"] == "session" and (message["recording"] is not None) != self._recording:
            self._changed.set()

    def _see_run(self) -> None:
        if self._filming and self._bridge.run != self._informed_run:
            self._changed.set()

    async def _run(self) -> None:
        while True:
            self._changed.clear()
            recording = self._recorder.session is not None
            films = recording and self._choice.now.record
            pause = RENEWAL_SECONDS
            if (films or self._filming) and not await self._tell(LEASE_SECONDS if films else 0.0):
                pause = RETRY_SECONDS
            if self._filming and not films:
                await asyncio.to_thread(self._choice.store_sizes)
            self._recording, self._filming = recording, films
            with suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._changed.wait()

    async def _tell(self, seconds: float) -> bool:
        """Return False where the runtime has not confirmed it."""
        choice = self._choice.now
        command = FilmCommand(seconds=seconds, rate=choice.rate, quality=choice.quality)
        self._informed_run = self._bridge.run
        try:
            await self._bridge.command(command.policy.name, command.payload())
        except (RuntimeSilentError, RefusedError):
            return False
        return True
