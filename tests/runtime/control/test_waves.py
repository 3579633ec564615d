"""The swing that waves leave of a held depth: the least that fins of this thrust can do."""

from math import pi

import numpy as np
import pytest

from robot_runtime.control.controllers.heave import LINEAR, TURNING_ROUND
from robot_runtime.control.controllers.predictive import Predictive

GRAVITY = 9.81
"""m/s²"""
STEP = 0.01
"""s"""
PERIODS = 8
"""Waves until the motion repeats itself."""


def swings(amplitude: float, period: float, depth: float, turn: float) -> np.ndarray:
    """Return the swing (m) of each plan of strokes: down and up in turn, from each moment, for each duration.

    The water takes a submerged hull along as the water that it displaces; drag and fins act on it besides.
    Deep water's waves fall off by e^(-k depth), k = ω²/g (J. N. Newman, Marine Hydrodynamics, 1977, 6.2). The
    waves are known beforehand, and the mean depth is held for nothing: the best case of any controller.
    """
    rate = 2 * pi / period
    water = amplitude * np.exp(-(rate**2) / GRAVITY * depth)
    most = period / 2 - turn
    begins, lasts = np.meshgrid(np.arange(0.0, period, 0.1), np.linspace(0.0, most, 12))
    thrust, drag = Predictive.limits["thrust"].default, Predictive.limits["drag"].default
    speed = np.zeros_like(begins)
    where, least, greatest = speed.copy(), speed + np.inf, speed - np.inf
    steps = round(period / STEP)
    for step in range(PERIODS * steps):
        time = step * STEP
        down = (time - begins) % period < lasts
        up = (time - begins - period / 2) % period < lasts
        through = speed - water * rate * np.cos(rate * time)
        speed = speed + STEP * (
            thrust * (1.0 * down - up)
            - water * rate**2 * np.sin(rate * time)
            - drag * abs(through) * through
            - LINEAR * through
        )
        where = where + STEP * speed
        if step >= (PERIODS - 1) * steps:
            least, greatest = np.minimum(least, where), np.maximum(greatest, where)
    result: np.ndarray = greatest - least
    return result


def test_a_hull_that_rests_is_taken_along_by_the_wave() -> None:
    still = swings(0.15, 3.0, 0.8, TURNING_ROUND)[0]
    assert still == pytest.approx(0.21, abs=0.005)


@pytest.mark.parametrize(("depth", "best"), [(0.8, 0.095), (1.5, 0.038)])
def test_turning_the_fins_bounds_what_any_controller_holds(depth: float, best: float) -> None:
    assert swings(0.15, 3.0, depth, TURNING_ROUND).min() == pytest.approx(best, abs=0.005)


def test_fins_that_turned_at_once_would_hold_it_closer() -> None:
    assert swings(0.15, 3.0, 0.8, 0.0).min() < 0.08
