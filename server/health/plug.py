"""The plug of health: processes, their state, and the alarms about them."""

import asyncio
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from server.feature import Plug
from server.health.faults import SERVER_FAULTS
from server.health.monitor import HealthMonitor
from server.health.watchdog import DOWN, Watchdog
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand
from server.processes.supervisor import SIMULATION, SIMULATION_ELSEWHERE, ProcessSupervisor
from server.services import Maker
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.feed import Feed
from server.stream.hub import Hub

HEALTH_SECONDS = 1.0


@dataclass(frozen=True, slots=True)
class ServerStart:
    """The start of this server: the processes that it keeps running, and the end of the server before.

    `ended` is a sentence about an unexpected end, empty where there was none.
    """

    processes: tuple[ProcessCommand, ...]
    ended: str


def make_alarms(clock: Clock, notices: Notices, hub: Hub) -> Alarms:
    """Return the alarms of the server, which the pages are sent at each change."""
    alarms = Alarms(clock, SERVER_FAULTS, notices.add_event, changed=lambda: announce(alarms, hub))
    return alarms


def announce(alarms: Alarms, hub: Hub) -> None:
    """Send the alarms to the pages."""
    hub.notify({"op": "alarms", "alarms": [asdict(alarm) for alarm in alarms.listed()]})


def make_processes(
    start: ServerStart, settings: Settings, clock: Clock, ends: "ProcessEnds"
) -> ProcessSupervisor:
    """Return the robot's processes."""
    return ProcessSupervisor(start.processes, settings.data, clock, ends.see)


class ProcessEnds:
    """The reaction to the unexpected end of a process."""

    def __init__(self, alarms: Alarms, bridge: Bridge) -> None:
        self._alarms = alarms
        self._bridge = bridge
        self._stopping: asyncio.Task[None] | None = None

    def see(self, part: str, text: str) -> None:
        """Handle the end of a part, with a sentence about it."""
        self._alarms.begin(DOWN[part], text)
        if part == "simulator":
            self._stopping = asyncio.create_task(self._stop_without_water())

    async def _stop_without_water(self) -> None:
        # The simulator may be back before the frozen sensors are a fault, with the robot at another place.
        with suppress(RefusedError, RuntimeSilentError):
            await self._bridge.disarm()


class HealthPlug(Plug):
    """The plug that starts the processes, watches them, and ends them last."""

    makers: ClassVar[tuple[Maker, ...]] = (make_alarms, make_processes)

    def __init__(
        self,
        settings: Settings,
        alarms: Alarms,
        processes: ProcessSupervisor,
        monitor: HealthMonitor,
        watchdog: Watchdog,
        hub: Hub,
        feed: Feed,
    ) -> None:
        self._settings = settings
        self._alarms = alarms
        self._processes = processes
        self._monitor = monitor
        self._watchdog = watchdog
        self._hub = hub
        feed.listen(monitor.see)
        feed.on_failure = lambda name, problem: alarms.begin("server_task_failed", f"{name}: {problem}.")

    async def open(self) -> None:
        """End processes of a killed server that this one does not use."""
        await self._processes.end_others()

    async def start(self) -> None:
        """Announce the alarms; start no simulation here if it runs on another computer."""
        announce(self._alarms, self._hub)
        if self._settings.hil.simulator == "elsewhere":
            for name in SIMULATION:
                await self._processes.pause(name, SIMULATION_ELSEWHERE)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Watch the parts, and send the pages their health."""
        return (self._watchdog.run(), self._notify_health())

    async def stop(self) -> None:
        """End every process."""
        await self._processes.stop()

    async def _notify_health(self) -> None:
        while True:
            parts = [part.model_dump() for part in self._monitor.health().parts]
            self._hub.notify({"op": "health", "parts": parts})
            await asyncio.sleep(HEALTH_SECONDS)
