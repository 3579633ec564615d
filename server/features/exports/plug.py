"""The plug of exports and imports."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from server.feature import Plug
from server.features.exports.imports import Imports
from server.features.exports.jobs import Jobs
from server.features.sessions.retention import RetentionWorker
from server.platform.settings import Settings
from server.platform.store import Store
from server.services import Maker


def make_jobs(settings: Settings, store: Store, clock: Clock) -> Jobs:
    """The exports."""
    return Jobs(settings.data, store, clock)


class ExportsPlug(Plug):
    """Makes the exports that were asked for."""

    makers: ClassVar[tuple[Maker, ...]] = (make_jobs,)

    def __init__(self, jobs: Jobs, imports: Imports, retention: RetentionWorker) -> None:
        self._jobs = jobs
        self._imports = imports
        retention.on_purge.append(jobs.see_purged)

    async def open(self) -> None:
        """Find the files of earlier servers."""
        await self._imports.recover()
        self._jobs.open()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Make one export after the other."""
        return (self._jobs.run(),)
