"""The plug of the library of sessions."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from server.feature import Plug
from server.library.catalogue import Catalogue
from server.library.clock_correction import ClockCorrection
from server.library.retention import RetentionWorker
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.services import Maker


def make_catalogue(store: Store, recorder: Recorder) -> Catalogue:
    """Return the list of sessions."""
    return Catalogue(store, recorder)


class SessionsPlug(Plug):
    """The plug that removes expired sessions, and corrects dates recorded before the clock was set."""

    makers: ClassVar[tuple[Maker, ...]] = (make_catalogue,)

    def __init__(self, retention: RetentionWorker, correction: ClockCorrection) -> None:
        self._retention = retention
        self._correction = correction

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Remove expired sessions, and correct dates."""
        return (self._retention.run(), self._correction.run())
