import numpy as np
import pytest

from server.metrics.series import Floats
from server.metrics.strokes import count_strokes

RATE = 50.0


def sampled(seconds: float) -> Floats:
    return np.arange(0, seconds, 1 / RATE).astype(np.float64)


def test_each_flap_is_a_stroke() -> None:
    times = sampled(100.0)
    flapping = 0.8 * np.sin(2 * np.pi * 1.3 * times)
    assert count_strokes(flapping) == pytest.approx(130, abs=1)


def test_encoder_noise_is_no_stroke() -> None:
    times = sampled(100.0)
    count = 2 * np.pi / 1024
    jitter = np.random.default_rng(1).integers(-1, 2, times.size) * count
    assert count_strokes(jitter) == 0
    assert count_strokes(np.tile([0.0, count], 5000)) == 0
    assert count_strokes(0.8 * np.sin(2 * np.pi * 1.3 * times) + jitter) == pytest.approx(130, abs=1)


def test_a_turn_about_the_mount_is_one_swing() -> None:
    """Angles wrap at half a turn; a fin that goes once round has not flapped."""
    turn = np.linspace(0, 2 * np.pi, 200)
    assert count_strokes(np.angle(np.exp(1j * turn))) == 0.5


def test_small_swings_within_a_large_one_do_not_count() -> None:
    assert count_strokes(np.array([0.0, 0.5, 0.4, 1.0, 0.0])) == 1
    assert count_strokes(np.array([0.0, 0.01, -1.0])) == 0.5
    assert count_strokes(np.array([-1.0, 0.0, -0.01])) == 0.5


@pytest.mark.parametrize("values", [[], [0.3], [0.3, 0.3], [0.0, 0.1]])
def test_a_resting_fin_has_no_strokes(values: list[float]) -> None:
    assert count_strokes(np.array(values)) == 0


@pytest.mark.parametrize("seed", range(20))
def test_the_count_equals_the_definition_applied_step_by_step(seed: int) -> None:
    angle = np.cumsum(np.random.default_rng(seed).normal(0, 0.05, 2000))
    assert count_strokes(angle) == swings(angle.tolist(), 0.2) / 2


def swings(values: list[float], least: float) -> int:
    """Return the strokes by the plain definition: a swing begins once the fin is back by the least."""
    count, direction = 0, 0
    low = high = values[0]
    for value in values:
        low, high = min(low, value), max(high, value)
        if direction <= 0 and value - low >= least:
            count, direction, high = count + 1, 1, value
        elif direction >= 0 and high - value >= least:
            count, direction, low = count + 1, -1, value
    return count
