from math import pi

import numpy as np
import pytest

from server.metrics.limit_cycle import find_limit_cycle
from server.metrics.series import Floats, Series

RATE = 50.0


def sampled(seconds: float) -> Floats:
    return np.arange(0, seconds, 1 / RATE).astype(np.float64)


@pytest.mark.parametrize("period", [0.8, 3.0, 7.3])
def test_a_sine(period: float) -> None:
    times = sampled(60.0)
    cycle = find_limit_cycle(Series(times, 0.2 + 0.05 * np.sin(2 * np.pi * times / period + 1)))
    assert cycle is not None
    assert cycle.period == pytest.approx(period, rel=0.005)
    assert cycle.amplitude == pytest.approx(0.1, rel=0.01)
    assert cycle.correlation > 0.99


def test_noise_on_a_sine_changes_little() -> None:
    times = sampled(60.0)
    noise = np.random.default_rng(3).normal(0, 0.005, times.size)
    cycle = find_limit_cycle(Series(times, 0.05 * np.sin(2 * np.pi * times / 3) + noise))
    assert cycle is not None
    assert cycle.period == pytest.approx(3.0, rel=0.02)
    assert cycle.amplitude == pytest.approx(0.1, rel=0.1)


def relay_cycle(delay: float, seconds: float) -> Series:
    """Return a relay of ±1 on an integrator whose output reaches the relay late by `delay`: dy/dt = u(t).

    The triangle that results has the amplitude 2 `delay` peak to peak, and the period 4 `delay`.
    """
    rate = 1000.0
    times = np.arange(0, seconds, 1 / rate)
    late = round(delay * rate)
    error = np.zeros(times.size)
    for at in range(1, times.size):
        seen = error[at - late] if at >= late else 1.0
        error[at] = error[at - 1] + (-1 if seen > 0 else 1) / rate
    return Series(times, error)


def test_a_relay_with_a_delay() -> None:
    cycle = find_limit_cycle(relay_cycle(0.5, 40.0).within(10.0, 40.0))
    assert cycle is not None
    assert cycle.period == pytest.approx(4 * 0.5, abs=0.01)
    assert cycle.amplitude == pytest.approx(2 * 0.5, rel=0.07)  # the peaks of a triangle are rounded off


@pytest.mark.parametrize("seed", range(10))
def test_noise_is_no_limit_cycle(seed: int) -> None:
    times = sampled(60.0)
    assert find_limit_cycle(Series(times, np.random.default_rng(seed).normal(0, 0.002, times.size))) is None


def test_rest_or_drift_is_no_limit_cycle() -> None:
    times = sampled(30.0)
    for values in (np.full(times.size, 0.3), 0.01 * times, np.exp(-times / 5)):
        assert find_limit_cycle(Series(times, values)) is None


def test_two_periods_are_too_few() -> None:
    times = sampled(6.0)
    assert find_limit_cycle(Series(times, np.sin(2 * pi * times / 3))) is None
    assert find_limit_cycle(Series(times[:3], times[:3])) is None


def test_the_amplitude_of_a_square_wave_is_exact() -> None:
    times = sampled(60.0)
    cycle = find_limit_cycle(Series(times, np.where(times % 2 < 1, 0.1, -0.1)))
    assert cycle is not None
    assert (cycle.period, cycle.amplitude) == (pytest.approx(2.0, abs=0.02), pytest.approx(0.2))
