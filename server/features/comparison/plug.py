"""The plug of comparisons."""

from typing import ClassVar

from server.feature import Plug
from server.features.comparison.worker import ComparisonWorker
from server.platform.settings import Settings
from server.services import Maker


def make_worker(settings: Settings) -> ComparisonWorker:
    """The process that compares."""
    return ComparisonWorker(settings.data.database)


class ComparisonPlug(Plug):
    """Has the process ready where there is memory to spare."""

    makers: ClassVar[tuple[Maker, ...]] = (make_worker,)

    def __init__(self, worker: ComparisonWorker) -> None:
        self._worker = worker

    def warm_up(self) -> None:
        """Start the process."""
        self._worker.prepare()

    async def stop(self) -> None:
        """End the process."""
        await self._worker.close()
