"""Votes of the last pictures, so that a single wrong picture neither shows nor hides anything."""

from collections import deque
from collections.abc import Collection

from robot_runtime.contract.vision_settings import PICTURES_MAX

GAP_SECONDS = 1.0
"""s between two pictures, after which those before say nothing of now."""


class Sightings:
    """The names of the sights in each of the last pictures."""

    def __init__(self) -> None:
        self._shown: deque[Collection[str]] = deque(maxlen=PICTURES_MAX)
        self._taken = 0.0

    def add(self, names: Collection[str], taken: float) -> None:
        """Add the names that a picture shows, which was taken at `taken` s."""
        if taken - self._taken > GAP_SECONDS:
            self._shown.clear()
        self._taken = taken
        self._shown.append(names)

    def confirmed(self, needed: int, pictures: int) -> list[str]:
        """Return the names, in alphabetical order, that `needed` of the last `pictures` show."""
        last = list(self._shown)[-pictures:]
        names = sorted({name for shown in last for name in shown})
        return [name for name in names if sum(name in shown for shown in last) >= needed]
