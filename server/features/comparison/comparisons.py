"""The comparer of a server, made at its first use, since it loads NumPy."""

from functools import cached_property
from typing import TYPE_CHECKING

from server.platform.store import Reader

if TYPE_CHECKING:
    from server.features.comparison.comparer import Comparer


class Comparisons:
    """Holds the one comparer of a server."""

    def __init__(self, store: Reader) -> None:
        self._store = store

    @cached_property
    def comparer(self) -> "Comparer":
        """The comparer, which caches results about complete sessions."""
        from server.features.comparison.comparer import Comparer

        return Comparer(self._store)
