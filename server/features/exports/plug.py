"""The plug of exports and imports."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from server.feature import Plug
from server.features.exports.imports import Imports
from server.features.exports.jobs import Jobs
from server.library.intake import ArchiveIntake
from server.library.retention import RetentionWorker
from server.services import Maker


def make_intake(imports: Imports) -> ArchiveIntake:
    """Return the import of archives."""
    return imports


class ExportsPlug(Plug):
    """The plug that makes the requested exports."""

    makers: ClassVar[tuple[Maker, ...]] = (make_intake,)

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
