"""The container: the services and plugs of a server, started and ended in phases."""

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from pkgutil import resolve_name
from typing import Any

from robot_runtime.clock import Clock, SteadyClock
from robot_runtime.control.alarms import Alarms
from server.driving.plug import DrivingPlug
from server.feature import Feature, Plug, list_features
from server.health.plug import HealthPlug, ServerStart
from server.http.plug import HttpPlug, ShellToken
from server.platform.settings import DataFolder, Settings
from server.platform.store import Store
from server.processes.managed_process import ProcessCommand
from server.recording.plug import RecorderPlug
from server.services import Services
from server.stream.plug import StreamPlug

log = logging.getLogger(__name__)

BASE: tuple[type[Plug], ...] = (HttpPlug, StreamPlug, HealthPlug, DrivingPlug, RecorderPlug)
"""The plugs without which there is no server: opened first, ended last."""


class Container:
    """The services that live as long as the server.

    `ended` is a sentence about the unexpected end of the server before this one; empty without one.
    """

    def __init__(
        self, settings: Settings, commands: Sequence[ProcessCommand], token: str, ended: str = ""
    ) -> None:
        self.settings = settings
        self.services = Services()
        self.services.add(Settings, settings)
        self.services.add(DataFolder, settings.data)
        self.clock: Clock = SteadyClock()
        self.services.add(Clock, self.clock)  # type: ignore[type-abstract]
        self.services.add(Store, Store(settings.data.database_location))
        self.services.add(ShellToken, ShellToken(token))
        self.services.add(ServerStart, ServerStart(tuple(commands), ended))
        plugs = [*BASE, *(resolve_name(feature.plug) for feature in features_on(settings) if feature.plug)]
        for plug in plugs:
            self.services.offer(*plug.makers)
        self._plugs: list[Plug] = [self.services.get(plug) for plug in plugs]

    @asynccontextmanager
    async def run(self) -> AsyncIterator[None]:
        """Start everything; end everything. Raise SetupError, StoreError."""
        tasks: list[asyncio.Task[None]] = []
        try:
            for plug in self._plugs:
                await plug.open()
            for plug in self._plugs:
                await plug.start()
            tasks += [self._begin(work) for plug in self._plugs for work in plug.work()]
            yield
        finally:
            ends: list[Callable[[], Awaitable[object]]] = [lambda: _cancel(tasks)]
            ends += [plug.stop for plug in reversed(self._plugs)]
            ends += [plug.close for plug in reversed(self._plugs)]
            # Also where one of them fails: what is left open keeps the process.
            async with AsyncExitStack() as ending:
                for end in reversed(ends):
                    ending.push_async_callback(end)

    def warm_up(self) -> None:
        """Prepare the services that are likely to be needed."""
        for plug in self._plugs:
            plug.warm_up()

    def _begin(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Begin a background task; its failure is logged and raises an alarm."""
        task = asyncio.create_task(work, name=getattr(work, "__qualname__", None))
        task.add_done_callback(self._see_failed)
        return task

    def _see_failed(self, task: asyncio.Task[None]) -> None:
        if task.cancelled() or (problem := task.exception()) is None:
            return
        name = task.get_name()
        log.error("the background task %s has failed", name, exc_info=problem)
        self.services.get(Alarms).begin("server_task_failed", f"Its task {name} ended: {problem}.")


def features_on(settings: Settings) -> list[Feature]:
    """Return the features that are on."""
    return [feature for feature in list_features().values() if settings.has(feature)]


async def _cancel(tasks: Sequence[asyncio.Task[None]]) -> None:
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
