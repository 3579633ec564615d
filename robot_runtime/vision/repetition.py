"""Detection of a camera that repeats one picture: noise makes two pictures of a working one differ."""

import numpy as np

from robot_runtime.vision.picture import Picture

REPEATS = 10
"""Equal pictures in a row. Some drivers repeat a few where light is scarce and exposures are long."""
REPEATING_SECONDS = 2.0
"""s for which they last at least."""
_ROWS_APART = 16
"""Of the rows that are compared first: noise differs in them already, so that the rest is seldom read."""


class PictureRepetition:
    """Counts how often a camera gives the same picture."""

    def __init__(self) -> None:
        self._picture: Picture | None = None
        self._since, self._count = 0.0, 0

    def repeats(self, picture: Picture, now: float) -> bool:
        """Takes a picture at `now` (s); returns True if it has repeated for too often and too long."""
        before, self._picture = self._picture, picture
        if before is None or not _equal(before, picture):
            self._since, self._count = now, 0
            return False
        self._count += 1
        return self._count >= REPEATS and now - self._since >= REPEATING_SECONDS


def _equal(one: Picture, other: Picture) -> bool:
    return np.array_equal(one[::_ROWS_APART], other[::_ROWS_APART]) and np.array_equal(one, other)
