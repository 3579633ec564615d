"""The plug of the roster: the router runs, and presences come in."""

import asyncio
from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.roster.roster import Roster
from server.features.roster.router_process import RouterProcess
from server.health.monitor import HealthMonitor
from server.platform.authority import Authority
from server.platform.lab_network import ROBOTS
from server.platform.settings import Settings


class RosterPlug(Plug):
    """The plug that keeps the router running as long as the lab's server."""

    def __init__(
        self, settings: Settings, router: RouterProcess, roster: Roster, monitor: HealthMonitor
    ) -> None:
        self._settings = settings
        self._router = router
        self._roster = roster
        if settings.lab:
            monitor.more |= {"router": router.condition, "robots": roster.condition}

    async def open(self) -> None:
        """Make the lab's certificates at its first start."""
        if self._settings.lab:
            await asyncio.to_thread(Authority(self._settings, ROBOTS).prepare)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Keep the router running, and listen to the robots."""
        # A server that has every feature, to describe the interface, is no lab.
        if not self._settings.lab:
            return ()
        return (self._router.run(), self._roster.connect(), self._roster.measure_clocks())

    async def close(self) -> None:
        """Close the way to the robots."""
        await self._roster.close()
