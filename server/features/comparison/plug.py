"""The plug of comparisons and summaries."""

from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.comparison.figure_worker import FigureWorker
from server.features.comparison.summaries import SummaryWorker
from server.features.comparison.worker import ComparisonWorker
from server.platform.settings import Settings


class ComparisonPlug(Plug):
    """The plug that starts the process early where memory allows it, and has it read what is new."""

    def __init__(
        self, worker: ComparisonWorker, summaries: SummaryWorker, figures: FigureWorker, settings: Settings
    ) -> None:
        self._figures = figures if settings.lab else None
        self._is_lean = settings.robot.profile == "lean"
        self._worker = worker
        self._summaries = summaries

    def warm_up(self) -> None:
        """Start the process; where processor time is scarce, only when somebody asks."""
        if not self._is_lean:
            self._worker.prepare()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Make summaries of the sessions that have ended, and in a lab their figures."""
        return (self._summaries.run(), *(() if self._figures is None else (self._figures.run(),)))

    async def stop(self) -> None:
        """End the process."""
        await self._worker.close()
