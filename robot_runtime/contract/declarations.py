"""Tables of declared things, whose numbers and names are unique."""

import sys
from collections.abc import Hashable
from typing import TypeVar

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


class DeclaredTwiceError(TypeError):
    """A number or name is declared a second time; the text names both places."""


class Declarations(dict[K, V]):
    """Declared things by number or name, in the order of their declaration; `kind` names the key."""

    def __init__(self, kind: str) -> None:
        super().__init__()
        self._kind = kind
        self._places: dict[K, str] = {}

    def add(self, key: K, thing: V, depth: int = 0) -> None:
        """Adds what is declared `depth` calls above the caller. Raises DeclaredTwiceError."""
        frame = sys._getframe(depth + 1)
        place = f"{frame.f_code.co_filename}:{frame.f_lineno}"
        if key in self:
            raise DeclaredTwiceError(
                f"{self._kind} {key!r} is declared twice: at {self._places[key]} and at {place}. "
                "Choose another one."
            )
        self[key], self._places[key] = thing, place
