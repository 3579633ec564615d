"""Against the second-order system's step response, which is known in closed form."""

from math import acos, exp, pi, sqrt

import numpy as np
import pytest

from server.metrics.series import Floats, Series
from server.metrics.step_response import measure_step

WN = 2.0
"""rad/s"""
STEP, FROM, TO = 3.0, 0.1, 0.6


def second_order(damping: float, since: Floats) -> Floats:
    """Return the response from 0 to 1 of wn² / (s² + 2 ζ wn s + wn²)."""
    if damping == 1:
        return 1 - np.exp(-WN * since) * (1 + WN * since)
    wd = WN * sqrt(1 - damping**2)
    phase = acos(damping)
    return 1 - np.exp(-damping * WN * since) / sqrt(1 - damping**2) * np.sin(wd * since + phase)


def respond(damping: float, seconds: float = 20.0, rate: float = 200.0) -> Series:
    times = np.arange(0, STEP + seconds, 1 / rate)
    since = np.maximum(times - STEP, 0)
    return Series(times, FROM + (TO - FROM) * np.where(times >= STEP, second_order(damping, since), 0.0))


@pytest.mark.parametrize("damping", [0.2, 0.4, 0.6])
def test_overshoot_and_its_time(damping: float) -> None:
    response = measure_step(respond(damping), STEP, 23.0, TO)
    assert response is not None
    assert response.overshoot == pytest.approx(exp(-pi * damping / sqrt(1 - damping**2)), abs=1e-3)
    assert response.peak_time == pytest.approx(STEP + pi / (WN * sqrt(1 - damping**2)), abs=0.01)
    assert response.peak == pytest.approx(TO + (TO - FROM) * response.overshoot)


def test_rise_time_of_a_critically_damped_system() -> None:
    response = measure_step(respond(1.0), STEP, 23.0, TO)
    assert response is not None
    # 1 - exp(-x) (1 + x) is 0.1 at x = 0.531812 and 0.9 at x = 3.889720.
    assert response.rise_time == pytest.approx((3.889720 - 0.531812) / WN, abs=1e-3)
    assert response.overshoot == 0
    assert response.peak is None


def test_settling_time_of_a_critically_damped_system() -> None:
    response = measure_step(respond(1.0), STEP, 23.0, TO)
    assert response is not None
    # ... and 0.95 at x = 4.743865.
    assert response.settling_time == pytest.approx(4.743865 / WN, abs=0.006)
    wide = measure_step(respond(1.0), STEP, 23.0, TO, band=0.05)
    assert wide is not None
    assert wide.settling_time == pytest.approx(3.889720 / WN, abs=0.006)


def test_the_last_time_out_of_the_band_counts() -> None:
    """A weakly damped response leaves the band again: its envelope gives a bound, its maxima the time."""
    response = measure_step(respond(0.2), STEP, 23.0, TO)
    assert response is not None
    assert response.settling_time is not None
    since = np.arange(0, 20, 1e-4)
    outside = since[np.abs(second_order(0.2, since) - 1) > 0.05]
    assert response.settling_time == pytest.approx(outside[-1], abs=0.006)
    assert response.settling_time < -np.log(0.05 * sqrt(1 - 0.04)) / (0.2 * WN)


def test_a_step_upwards_gives_the_same_figures() -> None:
    down = respond(0.4)
    up = Series(down.times, -down.values)
    first, other = measure_step(down, STEP, 23.0, TO), measure_step(up, STEP, 23.0, -TO)
    assert first is not None
    assert other is not None
    assert first.overshoot == pytest.approx(other.overshoot)
    assert first.rise_time == pytest.approx(other.rise_time)
    assert first.settling_time == pytest.approx(other.settling_time)


def test_a_response_that_never_arrives_has_no_times() -> None:
    slow = measure_step(respond(1.0), STEP, STEP + 1.0, TO)
    assert slow is not None
    assert slow.rise_time is None
    assert slow.settling_time is None
    assert slow.overshoot == 0


def test_a_lasting_oscillation_does_not_settle() -> None:
    times = np.arange(0, 60, 0.02)
    swinging = Series(times, np.where(times < 1, times * 0.5, 0.5 + 0.1 * np.sin(2 * np.pi * times / 3)))
    for end in np.arange(57.0, 60.0, 0.1):
        response = measure_step(swinging, 0.0, end, 0.5)
        assert response is not None
        assert response.settling_time is None


def test_without_a_step_there_is_no_response() -> None:
    times = np.arange(0, 10, 0.02)
    still = Series(times, np.full(times.size, 0.5))
    assert measure_step(still, 1.0, 9.0, 0.5) is None
    assert measure_step(still, 20.0, 30.0, 1.0) is None
