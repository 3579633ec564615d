"""The plug of updates."""

from server.feature import Plug
from server.features.installation.page_updates import PageUpdates


class InstallationPlug(Plug):
    """The plug that removes a killed server's unfinished files."""

    def __init__(self, updates: PageUpdates) -> None:
        self._updates = updates

    async def open(self) -> None:
        """Remove an unfinished upload."""
        self._updates.recover()
