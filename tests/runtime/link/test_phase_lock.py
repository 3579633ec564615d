"""Control ticks in phase with the board's depths, on clocks that differ."""

from itertools import pairwise
from math import floor

import pytest

from robot_runtime.link.phase_lock import EARLY, MISSED_MAX, PhaseLock

DEPTH_PERIOD = 0.02
SETTLED = 60
"""Ticks after which the drift of the clocks is known."""
WAKE = 0.0002
"""s from an arrival until it is seen."""
DELAY = 0.004
"""s from a depth's stamp to its arrival."""


class SteadyBoard:
    """A board that takes a depth every 20 ms of its own clock, slow by a share `drift`."""

    def __init__(self, drift: float) -> None:
        self._period = DEPTH_PERIOD * (1 + drift)

    def newest(self, now: float) -> float:
        """Return when the newest depth was taken that has arrived, s."""
        return floor((now - DELAY) / self._period) * self._period

    def next_arrival(self, now: float) -> float:
        """Return when the next depth arrives, s."""
        return self.newest(now) + self._period + DELAY


@pytest.mark.parametrize("drift", [0.0, 0.005, -0.005])
@pytest.mark.parametrize("late", [0.0005, 0.003])
@pytest.mark.parametrize("start", [0.1, 0.1037, 0.107, 0.113])
def test_ticks_use_fresh_depths_at_their_rate(drift: float, late: float, start: float) -> None:
    board = SteadyBoard(drift)
    phase = PhaseLock(start, 0.1, DEPTH_PERIOD)
    ages, times = [], []
    for _ in range(600):
        now, arrived = phase.due + late, None
        if phase.waits:
            end, now = now + phase.patience, board.next_arrival(now) + WAKE
            arrived = now if now < end else None
            now = min(now, end)
        ages.append(now - board.newest(now))
        times.append(now)
        phase.advance(now, arrived)
    assert max(ages[SETTLED:]) < 0.015
    assert max(abs(b - a - 0.1) for a, b in pairwise(times[SETTLED:])) < 0.01
    assert times[-1] - times[SETTLED] == pytest.approx((599 - SETTLED) * 0.1 * (1 + drift), abs=0.03)


def test_a_tick_that_begins_late_is_not_held_up_for_the_next_depth() -> None:
    phase = PhaseLock(1.0, 0.1, DEPTH_PERIOD)
    assert phase.patience > DEPTH_PERIOD
    phase.advance(1.0, 1.0)
    assert phase.patience < DEPTH_PERIOD


def test_the_phase_is_looked_for_again_where_no_depth_comes_in_it() -> None:
    phase = PhaseLock(1.0, 0.1, DEPTH_PERIOD)
    phase.advance(1.0, 1.0)
    for _ in range(MISSED_MAX):
        assert phase.patience < DEPTH_PERIOD
        phase.advance(phase.due, None)
    assert phase.patience > DEPTH_PERIOD


def test_a_missed_tick_is_not_made_up_for() -> None:
    phase = PhaseLock(1.0, 0.1, DEPTH_PERIOD)
    assert phase.due == pytest.approx(1.0 - EARLY)
    phase.advance(1.0, None)
    assert phase.due == pytest.approx(1.1 - EARLY)
    phase.advance(1.55, None)
    assert phase.due == pytest.approx(1.65 - EARLY)
