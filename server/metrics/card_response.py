"""Latencies from a card before the camera to the set point, and from the set point to the hull's motion."""

from collections.abc import Sequence

import numpy as np

from server.metrics.series import Series

MOTION_LEAST = 0.03
"""m towards the new set point that count as motion: more than strokes and noise move the depth by."""


def card_latencies(cards: Sequence[float], set_points: Sequence[float], end: float) -> list[float | None]:
    """Return the time (s) from each card's change to the next change of the set point.

    It is None where the next card, or the `end`, came first. All times are s, ascending.
    """
    latencies: list[float | None] = []
    for card, until in zip(cards, [*cards, end][1:], strict=True):
        later = [change - card for change in set_points if card < change <= until]
        latencies.append(later[0] if later else None)
    return latencies


def motion_latency(depth: Series, begin: float, end: float, set_point: float) -> float | None:
    """Return the time (s) from `begin` until the hull has moved by MOTION_LEAST towards the set point (m).

    A hull that still goes the other way must turn first: the motion counts from its turning point. None where
    it does not move so before `end`.
    """
    part = depth.within(begin, end)
    if part.times.size == 0:
        return None
    towards = part.values * np.sign(set_point - part.values[0])
    moved = np.flatnonzero(towards - np.minimum.accumulate(towards) >= MOTION_LEAST)
    return float(part.times[moved[0]]) - begin if moved.size else None
