"""The plug that has the camera filmed while a session is recorded."""

import asyncio
import logging
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any

from robot_runtime.contract.commands import FilmCommand
from robot_runtime.errors import RefusedError
from server.feature import Plug
from server.features.film.choice import FilmChoice
from server.recording.recorder import Recorder
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.hub import Hub

log = logging.getLogger(__name__)

LEASE_SECONDS = 60.0
"""s for which the robot films on without a server, whose next run stores the film."""
RENEWAL_SECONDS = 5.0
"""s until a runtime or a camera that was started again films, too."""


class FilmPlug(Plug):
    """The plug that has a recording session filmed: it says so at its begin, at changes, and in between."""

    def __init__(self, choice: FilmChoice, recorder: Recorder, bridge: Bridge, hub: Hub) -> None:
        self._choice = choice
        self._recorder = recorder
        self._bridge = bridge
        self._changed = asyncio.Event()
        self._recording = False
        self._filming = False
        if not choice.refusal:
            choice.changed = self._changed.set
            hub.listeners.append(self._see)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Have sessions filmed as it is chosen."""
        return () if self._choice.refusal else (self._run(),)

    def _see(self, message: dict[str, Any]) -> None:
        if message["op"] == "session" and (message["recording"] is not None) != self._recording:
            self._changed.set()

    async def _run(self) -> None:
        while True:
            self._changed.clear()
            recording = self._recorder.session is not None
            films = recording and self._choice.now.record
            if films or self._filming:
                await self._tell(LEASE_SECONDS if films else 0.0)
            if self._filming and not films:
                await asyncio.to_thread(self._choice.store_sizes)
            self._recording, self._filming = recording, films
            with suppress(TimeoutError):
                async with asyncio.timeout(RENEWAL_SECONDS):
                    await self._changed.wait()

    async def _tell(self, seconds: float) -> None:
        choice = self._choice.now
        command = FilmCommand(seconds=seconds, rate=choice.rate, quality=choice.quality)
        # A runtime that does not answer is told again.
        with suppress(RuntimeSilentError, RefusedError):
            await self._bridge.command(command.policy.name, command.payload())
