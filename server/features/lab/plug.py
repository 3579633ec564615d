"""The plug of a lab."""

from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.lab.pull import SessionPull


class LabPlug(Plug):
    """The plug that pulls sessions from robots."""

    def __init__(self, pull: SessionPull) -> None:
        self._pull = pull

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Pull what the archive lacks."""
        return (self._pull.run(),)

    async def stop(self) -> None:
        """End a download."""
        self._pull.stop()
