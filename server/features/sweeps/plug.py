"""The plug of sweeps."""

from typing import ClassVar

from server.feature import Plug
from server.features.sweeps.config import SweepsConfig
from server.features.sweeps.runner import SweepRunner
from server.features.sweeps.store import SweepStore
from server.platform.settings import Settings
from server.services import Maker
from server.stream.hub import Hub


def make_sweeps(settings: Settings, store: SweepStore, hub: Hub) -> SweepRunner:
    """Return the runner of sweeps."""
    return SweepRunner(settings, settings.section(SweepsConfig), store, hub.notify)


class SweepsPlug(Plug):
    """The plug that marks the sweeps of a killed server, and ends the present one with this server."""

    makers: ClassVar[tuple[Maker, ...]] = (make_sweeps,)

    def __init__(self, runner: SweepRunner) -> None:
        self._runner = runner

    async def start(self) -> None:
        """Mark what a killed server has left, and send the state to the pages."""
        await self._runner.recover()
        await self._runner.announce()

    async def stop(self) -> None:
        """End the running sweep; it can be resumed."""
        await self._runner.close()
