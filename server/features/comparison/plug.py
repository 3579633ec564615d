"""The plug of comparisons and summaries."""

from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.comparison.summaries import SummaryWorker
from server.features.comparison.worker import ComparisonWorker


class ComparisonPlug(Plug):
    """The plug that has the process read what is new, and ends it with the server."""

    def __init__(self, worker: ComparisonWorker, summaries: SummaryWorker) -> None:
        self._worker = worker
        self._summaries = summaries

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Make summaries of the sessions that have ended."""
        return (self._summaries.run(),)

    async def stop(self) -> None:
        """End the process."""
        await self._worker.close()
