"""The plug of backups."""

from typing import ClassVar

from server.feature import Plug
from server.features.backup.download import DatabaseDownloads
from server.platform.settings import Settings
from server.services import Maker


def make_downloads(settings: Settings) -> DatabaseDownloads:
    """The copies of the database for download."""
    return DatabaseDownloads(settings.data, settings.config)


class BackupPlug(Plug):
    """Removes what a killed server has left."""

    makers: ClassVar[tuple[Maker, ...]] = (make_downloads,)

    def __init__(self, downloads: DatabaseDownloads) -> None:
        self._downloads = downloads

    async def open(self) -> None:
        """Remove unfinished copies."""
        self._downloads.recover()
