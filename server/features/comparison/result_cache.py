"""Keeps what was found out about sessions that no longer change."""

from collections import OrderedDict
from threading import Lock
from typing import Generic, TypeVar

from server.platform.models import SessionRow

T = TypeVar("T")

RESULTS_KEPT = 64


class ResultCache(Generic[T]):
    """The newest results about complete sessions; may be used from several threads."""

    def __init__(self) -> None:
        self._results: OrderedDict[tuple[object, ...], T] = OrderedDict()
        self._lock = Lock()

    def recall(self, key: tuple[object, ...]) -> T | None:
        """What was kept under this key; None where it is not, or no more."""
        with self._lock:
            if key in self._results:
                self._results.move_to_end(key)
            return self._results.get(key)

    def keep(self, key: tuple[object, ...], result: T, row: SessionRow) -> None:
        """Keep it for a while, unless the session still records."""
        if row.state == "recording":
            return
        with self._lock:
            self._results[key] = result
            while len(self._results) > RESULTS_KEPT:
                self._results.popitem(last=False)
