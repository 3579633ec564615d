"""The plug that has the camera filmed while a session is recorded."""

import asyncio
import logging
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any

from robot_runtime.contract.commands import FilmCommand
from robot_runtime.errors import RefusedError
from server.feature import Plug
from server.features.film.config import FilmConfig
from server.platform.settings import Settings
from server.recording.recorder import Recorder
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.hub import Hub

log = logging.getLogger(__name__)

LEASE_SECONDS = 60.0
"""s for which the robot films on without a server, whose next run stores the film."""
RENEWAL_SECONDS = 5.0
"""s until a runtime or a camera that was started again films, too."""


class FilmPlug(Plug):
    """The plug that has a recording session filmed: it says so at its begin, its end and in between."""

    def __init__(self, settings: Settings, recorder: Recorder, bridge: Bridge, hub: Hub) -> None:
        self._config = settings.section(FilmConfig)
        self._recorder = recorder
        self._bridge = bridge
        self._changed = asyncio.Event()
        self._filming = False
        self._is_on = self._config.record and settings.robot.profile != "lean"
        if self._is_on:
            hub.listeners.append(self._see)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Have every session filmed."""
        return (self._run(),) if self._is_on else ()

    def _see(self, message: dict[str, Any]) -> None:
        if message["op"] == "session" and (message["recording"] is not None) != self._filming:
            self._changed.set()

    async def _run(self) -> None:
        while True:
            self._changed.clear()
            recording = self._recorder.session is not None
            if recording or self._filming:
                await self._tell(LEASE_SECONDS if recording else 0.0)
            self._filming = recording
            with suppress(TimeoutError):
                async with asyncio.timeout(RENEWAL_SECONDS):
                    await self._changed.wait()

    async def _tell(self, seconds: float) -> None:
        command = FilmCommand(seconds=seconds, rate=self._config.rate, quality=self._config.quality)
        # A runtime that does not answer is told again.
        with suppress(RuntimeSilentError, RefusedError):
            await self._bridge.command(command.policy.name, command.payload())
