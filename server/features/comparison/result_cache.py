"""Cache of results about sessions that no longer change."""

from collections import OrderedDict
from threading import Lock
from typing import Generic, TypeVar

from server.platform.models import SessionRow

T = TypeVar("T")

RESULTS_MOST = 64


class ResultCache(Generic[T]):
    """The newest results about complete sessions; may be used from several threads."""

    def __init__(self) -> None:
        self._results: OrderedDict[tuple[object, ...], T] = OrderedDict()
        self._lock = Lock()

    def get(self, key: tuple[object, ...]) -> T | None:
        """The result stored under this key; None where there is none or it was dropped."""
        with self._lock:
            if key in self._results:
                self._results.move_to_end(key)
            return self._results.get(key)

    def put(self, key: tuple[object, ...], result: T, row: SessionRow) -> None:
        """Store a result."""
        if row.state == "recording":
            return
        with self._lock:
            self._results[key] = result
            while len(self._results) > RESULTS_MOST:
                self._results.popitem(last=False)
