"""The plug of backups."""

from server.feature import Plug
from server.features.backup.download import DatabaseDownloads


class BackupPlug(Plug):
    """The plug that removes a killed server's unfinished files."""

    def __init__(self, downloads: DatabaseDownloads) -> None:
        self._downloads = downloads

    async def open(self) -> None:
        """Remove unfinished copies."""
        self._downloads.recover()
