"""The plug of comparisons."""

from server.feature import Plug
from server.features.comparison.worker import ComparisonWorker


class ComparisonPlug(Plug):
    """The plug that starts the process early where memory allows it."""

    def __init__(self, worker: ComparisonWorker) -> None:
        self._worker = worker

    def warm_up(self) -> None:
        """Start the process."""
        self._worker.prepare()

    async def stop(self) -> None:
        """End the process."""
        await self._worker.close()
