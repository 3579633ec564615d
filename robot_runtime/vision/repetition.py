"""Detection of a camera that repeats one picture: noise makes pictures of a working camera differ."""

import numpy as np

from robot_runtime.vision.camera import CameraFrame
from robot_runtime.vision.picture import Picture

REPEATS = 10
"""Equal pictures in a row. Some drivers repeat a few where light is scarce and exposures are long."""
REPEATING_SECONDS = 2.0
"""s for which they last at least."""
_ROWS_APART = 16
"""Of the rows that are compared first: noise differs in them already, so that the rest is seldom read."""


class PictureRepetition:
    """The repetitions of a camera's picture."""

    def __init__(self) -> None:
        self._frame: CameraFrame | None = None
        self._since, self._count = 0.0, 0

    def repeats(self, frame: CameraFrame, now: float) -> bool:
        """Take a frame at `now` (s); return True if its picture has repeated for too often and too long."""
        before, self._frame = self._frame, frame
        if before is None or not _same_picture(before, frame):
            self._since, self._count = now, 0
            return False
        self._count += 1
        return self._count >= REPEATS and now - self._since >= REPEATING_SECONDS


def _same_picture(frame: CameraFrame, other: CameraFrame) -> bool:
    if frame.original is not None and other.original is not None:
        return frame.original == other.original
    return _equal(frame.picture, other.picture)


def _equal(picture: Picture, other: Picture) -> bool:
    return np.array_equal(picture[::_ROWS_APART], other[::_ROWS_APART]) and np.array_equal(picture, other)
