"""Cache of results about sessions that no longer change."""

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock
from typing import Generic, TypeVar

from server.platform.models import SessionRow

T = TypeVar("T")
_Place = tuple[int | None, str, object]


class ResultCache(Generic[T]):
    """The newest results about complete sessions, of a limited total size; several threads may use it."""

    def __init__(self, most: int, size: Callable[[T], int] = lambda _: 1) -> None:
        self._most = most
        self._size = size
        self._total = 0
        self._results: OrderedDict[_Place, T] = OrderedDict()
        self._lock = Lock()

    def get(self, row: SessionRow, key: object) -> T | None:
        """The stored result about a session; None if there is none or it was dropped."""
        place = _place(row, key)
        with self._lock:
            if place in self._results:
                self._results.move_to_end(place)
            return self._results.get(place)

    def put(self, row: SessionRow, key: object, result: T) -> None:
        """Store a result, in place of the oldest ones; none about a session that is still recording."""
        if row.state == "recording" or self._size(result) > self._most:
            return
        place = _place(row, key)
        with self._lock:
            if place in self._results:
                self._total -= self._size(self._results.pop(place))
            self._results[place] = result
            self._total += self._size(result)
            while self._total > self._most:
                self._total -= self._size(self._results.popitem(last=False)[1])

    def compute(self, row: SessionRow, key: object, function: Callable[[], T]) -> T:
        """The stored result, or else the function's, which is stored."""
        result = self.get(row, key)
        if result is None:
            result = function()
            self.put(row, key, result)
        return result


def _place(row: SessionRow, key: object) -> _Place:
    # A session that is imported once more has its identifier, and perhaps other samples.
    return row.id, row.identifier, key
