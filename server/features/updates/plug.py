"""The plug of updates."""

from typing import ClassVar

from server.feature import Plug
from server.features.installation.places import InstallPlaces
from server.features.updates.page_updates import PageUpdates
from server.platform.settings import Settings
from server.services import Maker


def make_updates(settings: Settings) -> PageUpdates:
    """The updates that pages ask for."""
    return PageUpdates(settings.data, InstallPlaces())


class UpdatesPlug(Plug):
    """Removes what a killed server has left."""

    makers: ClassVar[tuple[Maker, ...]] = (make_updates,)

    def __init__(self, updates: PageUpdates) -> None:
        self._updates = updates

    async def open(self) -> None:
        """Remove an unfinished upload."""
        self._updates.recover()
