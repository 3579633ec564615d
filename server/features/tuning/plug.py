"""The plug of tuning."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from server.driving.changes import Changes
from server.feature import Plug
from server.features.tuning.predictor import StepPredictor
from server.features.tuning.runner import TuningRunner
from server.features.tuning.runs import TuningStore
from server.health.occupation import Occupation
from server.platform.notices import Notices
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub


def make_runner(
    runs: TuningStore,
    bridge: Bridge,
    changes: Changes,
    clock: Clock,
    hub: Hub,
    notices: Notices,
    occupation: Occupation,
) -> TuningRunner:
    """Return the runner of tuning experiments."""
    return TuningRunner(runs, bridge, changes, clock, hub.notify, notices.notify, occupation.of_robot)


class TuningPlug(Plug):
    """The plug that collects the samples of experiments."""

    makers: ClassVar[tuple[Maker, ...]] = (make_runner,)

    def __init__(self, tuning: TuningRunner, runs: TuningStore, predictor: StepPredictor, feed: Feed) -> None:
        self._tuning = tuning
        self._runs = runs
        self._predictor = predictor
        feed.listen(tuning.see)

    async def open(self) -> None:
        """Mark interrupted runs."""
        await self._runs.mark_interrupted()

    async def start(self) -> None:
        """Send the state to the pages."""
        self._tuning.announce()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Watch the active run."""
        return (self._tuning.run(),)

    async def stop(self) -> None:
        """End the running experiment, store it, and end the process of the predictions."""
        await self._tuning.close()
        await self._predictor.close()
