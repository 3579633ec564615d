"""Times at which pictures are due, in simulated time."""

import math

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.vision.node import RateTimer


def count(
    pace: RateTimer, clock: SimulatedClock, seconds: float, step: float = 0.001, costs: float = 0.0
) -> int:
    """Number of pictures due in this time, when each takes `costs` seconds."""
    done, end = 0, clock.now() + seconds
    while clock.now() < end - 1e-9:
        if pace.remaining() <= 0:
            pace.begin()
            done += 1
            clock.forward(costs)
        clock.forward(step)
    return done


@pytest.mark.parametrize("rate", [2.0, 4.0, 30.0])
def test_the_rate_is_exact(rate: float) -> None:
    clock = SimulatedClock(9.0)
    assert count(RateTimer(clock, rate), clock, 60) == pytest.approx(60 * rate, abs=1)


def test_time_that_a_picture_takes_does_not_slow_the_rhythm() -> None:
    clock = SimulatedClock()
    assert count(RateTimer(clock, 4.0), clock, 60, costs=0.2) == pytest.approx(240, abs=1)


def test_pictures_missed_by_a_long_computation_are_not_made_up_for() -> None:
    clock = SimulatedClock()
    pace = RateTimer(clock, 10.0)
    pace.begin()
    clock.forward(5.0)
    pace.begin()
    assert pace.remaining() == pytest.approx(0.1)


def test_first_is_due_at_once() -> None:
    assert RateTimer(SimulatedClock(3.0), 2.0).remaining() <= 0


def test_a_new_rate_applies_at_once() -> None:
    clock = SimulatedClock()
    pace = RateTimer(clock, 2.0)
    pace.begin()
    clock.forward(0.1)
    assert pace.remaining() == pytest.approx(0.4)
    pace.rate = 10.0
    assert pace.remaining() == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("rate", [0.0, 1.9, 30.1, -4.0, math.nan, math.inf])
def test_impossible_rates_are_refused(rate: float) -> None:
    pace = RateTimer(SimulatedClock(), 4.0)
    with pytest.raises(ValueError, match=r"not between 2 and 30 Hz"):
        pace.rate = rate
    assert pace.rate == 4.0
