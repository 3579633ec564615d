"""The plug of the communication test."""

from typing import ClassVar

from robot_runtime.clock import Clock
from server.board_reservation import BoardReservation
from server.feature import Plug
from server.features.comm_tests.runner import CommTestRunner
from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.shipped import import_samples
from server.platform.settings import Settings
from server.services import Maker
from server.stream.ends import RunEnds
from server.stream.hub import Hub


def make_runner(
    settings: Settings,
    runs: CommTestStore,
    clock: Clock,
    hub: Hub,
    reservation: BoardReservation,
    ends: RunEnds,
) -> CommTestRunner:
    """Return the runner of communication tests."""
    return CommTestRunner(settings, runs, clock, hub.notify, reservation.reserve, ends.see)


class CommTestPlug(Plug):
    """The plug that puts the shipped results into the database."""

    makers: ClassVar[tuple[Maker, ...]] = (make_runner,)

    def __init__(self, runner: CommTestRunner, runs: CommTestStore) -> None:
        self._runner = runner
        self._runs = runs

    async def open(self) -> None:
        """Mark interrupted runs."""
        await self._runs.mark_interrupted()
        await import_samples(self._runs)

    async def stop(self) -> None:
        """Cancel the running work."""
        await self._runner.close()
