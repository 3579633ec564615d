"""The formula of light in water, without rendering."""

import numpy as np
import pytest

from robot_runtime.simulation.scene.optics import UnderwaterOptics
from robot_runtime.simulation.scene.water import CLEAN, TURBIDITY_ATTENUATION, WaterOptics, water

LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
WIDTH, HEIGHT = 64, 48


@pytest.mark.parametrize("distance", [0.1, 1.0, 3.4, 20.0])
def test_the_colour_of_a_wall_follows_the_formula(distance: float) -> None:
    seen = WaterOptics((0.06, 0.09, 0.6), (150.0, 128.0, 30.0), 0.05, caustics=0.0)
    paint = (20, 190, 245)
    picture = np.full((HEIGHT, WIDTH, 3), paint, np.uint8)
    # Straight ahead, where distance and depth are the same, and up and down cancel out.
    wall = np.full((HEIGHT, WIDTH), distance, np.float32)
    look = UnderwaterOptics(WIDTH, HEIGHT, 1.0)
    result = look.apply(picture, wall, seen, (0.0, 0.0, 5.0), LEVEL, 0.0, noise=0.0)
    stored = np.exp(-np.array(seen.attenuation) * distance)
    expected = np.array(paint) * stored + np.array(seen.glow) * (1 - stored)
    assert result.reshape(-1, 3).mean(axis=0) == pytest.approx(expected, abs=1.0)


def test_noise_has_the_given_strength_and_depends_on_the_time() -> None:
    calm = WaterOptics((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, caustics=0.0)
    picture = np.full((HEIGHT, WIDTH, 3), 128, np.uint8)
    near = np.ones((HEIGHT, WIDTH), np.float32)
    look = UnderwaterOptics(WIDTH, HEIGHT, 48.8)
    first, same, other = (
        look.apply(picture, near, calm, (0.0, 0.0, 5.0), LEVEL, time, noise=4.0) for time in (1.0, 1.0, 1.05)
    )
    assert first.std() == pytest.approx(4.0, rel=0.05)
    assert first.tobytes() == same.tobytes() != other.tobytes()


def test_turbidity_reduces_visibility() -> None:
    assert water("pool", 0.0).attenuation == CLEAN["pool"].attenuation
    added = [
        water("natural", share).attenuation[0] - CLEAN["natural"].attenuation[0] for share in (0.1, 0.5, 1)
    ]
    assert added == sorted(added)
    assert added[-1] == pytest.approx(TURBIDITY_ATTENUATION)
    # At 1, a hand's breadth away, what is left of black on white is what an eye can just tell apart.
    assert np.exp(-water("natural", 1.0).attenuation[0] * 0.1) == pytest.approx(0.05, abs=0.01)
