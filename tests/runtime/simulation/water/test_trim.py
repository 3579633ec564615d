"""Buoyancy and trim, changed in motion."""

from dataclasses import replace
from itertools import pairwise
from math import asin, atan2, pi, sqrt

import pytest

from robot_runtime.simulation.water.geometry import normalize, rotation
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Trim
from tests.runtime.simulation.water.harness import NEUTRAL, STILL, UNDAMPED, drift, pushed


@pytest.mark.parametrize("buoyancy", [0.97, 0.997, 1.01, 1.05])
def test_rises_or_sinks_at_the_computed_speed(buoyancy: float) -> None:
    parameters = SimulationParameters(floor=1000.0)
    body = pushed(parameters, depth=500.0)
    body.trim = Trim(buoyancy, 0.0, 0.0, 0.01)
    net = parameters.weight * abs(buoyancy - 1)
    linear, quadratic = parameters.damping_linear[2], parameters.damping_quadratic[2]
    expected = (-linear + sqrt(linear**2 + 4 * quadratic * net)) / (2 * quadratic)
    before = drift(body, 60, 0.01).position[2]
    after = drift(body, 10, 0.01).position[2]
    assert after - before == pytest.approx(10 * (expected if buoyancy < 1 else -expected), rel=1e-5)


@pytest.mark.parametrize(("forward", "right"), [(0.003, 0.0), (-0.003, 0.0), (0.0, 0.002), (0.002, -0.003)])
def test_comes_to_rest_with_its_centre_of_buoyancy_on_top(forward: float, right: float) -> None:
    body = pushed(NEUTRAL)
    body.trim = Trim(1.0, forward, right, 0.01)
    matrix = rotation(drift(body, 120, 0.01).attitude)
    pitch, roll = -asin(matrix[2][0]), atan2(matrix[2][1], matrix[2][2])
    # Buoyancy before the centre lifts the nose, on the right the right side.
    assert pitch == pytest.approx(atan2(forward, sqrt(0.01**2 + right**2)), abs=1e-3)
    assert roll == pytest.approx(-atan2(right, 0.01), abs=1e-3)


@pytest.mark.parametrize("above", [0.005, 0.02])
def test_roll_period_follows_the_height_of_the_centre_of_buoyancy(above: float) -> None:
    body = pushed(UNDAMPED)
    body.trim = Trim(1.0, 0.0, 0.0, above)
    body.state = body.state._replace(attitude=normalize((1.0, 0.01, 0.0, 0.0)))
    rates = []
    for _ in range(4000):
        body.step(0.002, STILL, STILL)
        rates.append(body.state.rate[0])
    turns = [index for index, (early, late) in enumerate(pairwise(rates)) if early < 0 <= late]
    measured = 0.002 * (turns[-1] - turns[0]) / (len(turns) - 1)
    total = UNDAMPED.inertia[0] + UNDAMPED.added_mass[3]
    assert measured == pytest.approx(2 * pi * sqrt(total / (UNDAMPED.weight * above)), rel=2e-3)


def test_capsizes_with_the_centre_of_buoyancy_below() -> None:
    body = pushed(replace(NEUTRAL, floor=1000.0))
    body.trim = Trim(1.0, 0.0, 0.0, -0.01)
    body.state = body.state._replace(attitude=normalize((1.0, 0.01, 0.0, 0.0)))
    assert rotation(drift(body, 60, 0.01).attitude)[2][2] == pytest.approx(-1, abs=1e-3)


@pytest.mark.parametrize(
    "wrong",
    [(0.5, 0, 0, 0.01), (1.2, 0, 0, 0.01), (1, 0.06, 0, 0), (1, 0, -0.06, 0), (1, 0, 0, float("nan"))],
)
def test_impossible_trim_is_refused(wrong: tuple[float, float, float, float]) -> None:
    with pytest.raises(ValueError, match="must be between"):
        Trim(*wrong)
