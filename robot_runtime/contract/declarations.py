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
        self._locations: dict[K, str] = {}

    def add(self, key: K, thing: V, depth: int = 0) -> None:
        """Add a thing that is declared `depth` calls above the caller. Raise DeclaredTwiceError."""
        frame = sys._getframe(depth + 1)
        self.add_from(f"{frame.f_code.co_filename}:{frame.f_lineno}", key, thing)

    def add_from(self, location: str, key: K, thing: V) -> None:
        """Add a thing that is declared at this location. Raise DeclaredTwiceError."""
        if key in self:
            raise DeclaredTwiceError(
                f"{self._kind} {key!r} is declared twice: at {self._locations[key]} and at {location}. "
                "Choose another one."
            )
        super().__setitem__(key, thing)
        self._locations[key] = location

    def __setitem__(self, key: K, thing: V) -> None:
        """Add a thing that is declared here. Raise DeclaredTwiceError."""
        self.add(key, thing, depth=1)
