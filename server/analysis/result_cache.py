"""Cache of results about sessions that no longer change."""

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock
from typing import Generic, TypeVar

from server.platform.models import SessionRow

T = TypeVar("T")
_Key = tuple[int | None, str, object]
RESULTS_MAX = 64


class ResultCache(Generic[T]):
    """The newest results about complete sessions, of a limited total size; several threads may use it.

    Without a size, RESULTS_MAX of them.
    """

    def __init__(self, most: int | None = None, size: Callable[[T], int] = lambda _: 1) -> None:
        self._most = RESULTS_MAX if most is None else most
        self._size = size
        self._total = 0
        self._results: OrderedDict[_Key, T] = OrderedDict()
        self._lock = Lock()

    def get(self, row: SessionRow, key: object) -> T | None:
        """Return the stored result about a session; None without one."""
        entry = _key(row, key)
        with self._lock:
            if entry in self._results:
                self._results.move_to_end(entry)
            return self._results.get(entry)

    def put(self, row: SessionRow, key: object, result: T) -> None:
        """Store a result in place of the oldest ones, unless its session is still recording."""
        if row.state == "recording" or self._size(result) > self._most:
            return
        entry = _key(row, key)
        with self._lock:
            if entry in self._results:
                self._total -= self._size(self._results.pop(entry))
            self._results[entry] = result
            self._total += self._size(result)
            while self._total > self._most:
                self._total -= self._size(self._results.popitem(last=False)[1])

    def compute(self, row: SessionRow, key: object, function: Callable[[], T]) -> T:
        """Return the stored result, or else the function's, which is stored then."""
        result = self.get(row, key)
        if result is None:
            result = function()
            self.put(row, key, result)
        return result


def _key(row: SessionRow, key: object) -> _Key:
    # A session that is imported once more has its identifier, and perhaps other samples.
    return row.id, row.identifier, key
