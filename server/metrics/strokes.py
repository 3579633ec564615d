"""Counts of fin strokes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from server.metrics.series import Floats

SWING_LEAST = 0.2
"""rad; less is noise of the encoders (0.006 rad a count) and a fin that holds still."""


def count_strokes(angle: NDArray[np.floating[Any]], swing_least: float = SWING_LEAST) -> float:
    """Return the strokes of a fin, from its angle (rad, shape (samples,)): two swings, there and back, are
    one.

    A swing runs from a turning point to the next, where smaller swings within a larger one do not count
    (hysteresis filtering, as before rainflow counting: ASTM E1049-85).
    """
    angles = np.asarray(angle, np.float64)
    # Unwrapping costs as much as all the rest, and a fin seldom turns right round.
    turns = np.abs(np.diff(angles)).max(initial=0.0) >= np.pi
    return _swings(np.unwrap(angles) if turns else angles, swing_least) / 2


def _swings(values: Floats, least: float) -> int:
    points = values
    while points.size > 1:
        points = _turning_points(points)
        sizes = np.abs(np.diff(points))
        # Of equal neighbours every other one goes, so that a few rounds are enough.
        ranks = sizes * (1 + 1e-9 * (np.arange(sizes.size) % 2))
        padded = np.concatenate([[np.inf], ranks, [np.inf]])
        lowest = (sizes < least) & (ranks < padded[:-2]) & (ranks < padded[2:])
        at = np.flatnonzero(lowest)
        if not at.size:
            return int(np.count_nonzero(sizes >= least))
        inner = at[(at > 0) & (at < sizes.size - 1)]
        keep = np.ones(points.size, bool)
        keep[inner] = keep[inner + 1] = False
        # At the ends a small swing loses its outer point alone: the inner one begins the next swing.
        keep[0] = at[0] != 0
        keep[-1] = at[-1] != sizes.size - 1
        points = points[keep]
    return 0


def _turning_points(values: Floats) -> Floats:
    if values.size < 3:
        return values
    moved: Floats = values[np.concatenate([[True], np.diff(values) != 0])]
    steps = np.diff(moved)
    turns: Floats = moved[np.concatenate([[True], steps[1:] * steps[:-1] < 0, [True]])[: moved.size]]
    return turns
