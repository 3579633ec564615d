"""Sensor readings of a known motion."""

from dataclasses import replace
from math import cos, pi, sin

import pytest

from robot_runtime.simulation.water.geometry import BodyState, at_rest
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.sensors import Reading, Sensors
from robot_runtime.simulation.water.world import World
from tests.runtime.simulation.water.harness import QUIET as PERFECT_SENSORS

QUIET = replace(PERFECT_SENSORS, pressure_position=(0.0, 0.0, 0.0))
REST: Vector = (0.0, 0.0, 0.0)


def read(state: BodyState, acceleration: Vector = REST, parameters: SimulationParameters = QUIET) -> Reading:
    return Sensors(parameters, World(parameters), seed=1).read(0.005, state, acceleration, battery=7.5)


def turned(axis: Vector, angle: float, position: Vector = (0.0, 0.0, 1.0)) -> BodyState:
    x, y, z = (part * sin(angle / 2) for part in axis)
    return BodyState(position, (cos(angle / 2), x, y, z), REST, (0.1, 0.2, 0.3))


def test_accelerometer_at_rest_shows_gravity_upwards() -> None:
    assert read(at_rest(1.0)).force == pytest.approx((0, 0, -9.81))


def test_accelerometer_in_free_fall_shows_nothing() -> None:
    assert read(turned((1, 0, 0), 1.0), (0, 0, 9.81)).force == pytest.approx((0, 0, 0), abs=1e-12)


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ((1.0, 0.0, 0.0), (0.0, -9.81, 0.0)),
        ((0.0, 1.0, 0.0), (9.81, 0.0, 0.0)),
        ((0.0, 0.0, 1.0), (0.0, 0.0, -9.81)),
    ],
    ids=["right side down", "nose up", "turned right"],
)
def test_accelerometer_of_a_hull_turned_by_a_quarter(axis: Vector, expected: Vector) -> None:
    assert read(turned(axis, pi / 2)).force == pytest.approx(expected, abs=1e-12)


def test_accelerometer_shows_acceleration_in_body_axes() -> None:
    looking_east = turned((0, 0, 1), pi / 2)
    assert read(looking_east, (0.0, 2.0, 0.0)).force == pytest.approx((2.0, 0.0, -9.81))
    assert read(looking_east, (2.0, 0.0, 0.0)).force == pytest.approx((0.0, -2.0, -9.81))


def test_gyroscope_shows_the_turn_rate() -> None:
    assert read(turned((0, 1, 0), 0.7)).rate == (0.1, 0.2, 0.3)


@pytest.mark.parametrize("depth", [0.0, 0.5, 1.0, 2.95])
def test_pressure_grows_by_9810_pascal_a_metre(depth: float) -> None:
    assert read(at_rest(depth)).pressure == pytest.approx(101325 + 9810 * depth)


def test_pressure_in_air_is_that_of_the_surface() -> None:
    assert read(at_rest(-0.3)).pressure == 101325


def test_pressure_is_that_at_the_sensor() -> None:
    behind = replace(QUIET, pressure_position=(-0.1, 0.0, 0.0))
    nose_up = turned((0, 1, 0), pi / 2)
    assert read(nose_up, parameters=behind).pressure == pytest.approx(101325 + 9810 * 1.1)


@pytest.mark.parametrize(
    ("bearing", "distance", "right", "left"),
    [
        (0, 3, True, True),
        (50, 3, True, False),
        (-50, 3, False, True),
        (100, 3, True, False),
        (110, 3, False, False),
        (180, 3, False, False),
        (0, 7.9, True, True),
        (0, 8.1, False, False),
        (0, 0, True, True),
    ],
)
def test_beacon_detectors_see_ahead_and_to_their_own_side(
    bearing: float, distance: float, right: bool, left: bool
) -> None:
    angle = bearing * pi / 180
    parameters = replace(QUIET, beacons=((distance * cos(angle), distance * sin(angle), 1.0),))
    reading = read(at_rest(1.0), parameters=parameters)
    assert (reading.beacon_right, reading.beacon_left) == (right, left)


def test_beacon_detectors_turn_with_the_hull() -> None:
    parameters = replace(QUIET, beacons=((3.0, 0.0, 1.0),))
    reading = read(turned((0, 0, 1), 50 * pi / 180), parameters=parameters)
    assert (reading.beacon_right, reading.beacon_left) == (False, True)


def test_a_craft_s_fixed_offsets_are_added() -> None:
    offset = replace(QUIET, gyroscope_offset=(0.1, 0.0, -0.1), accelerometer_offset=(0.0, 0.2, 0.5))
    reading = read(at_rest(1.0), parameters=offset)
    assert reading.rate == pytest.approx((0.1, 0.0, -0.1))
    assert reading.force == pytest.approx((0.0, 0.2, -9.31))


def test_larger_and_blunter_fins_load_their_motors_more() -> None:
    """Strips give this: with the area, the coefficient, and the cube of the length."""
    assert read(at_rest(1.0)).fin_load == 1
    larger = replace(QUIET, fin_area=2 * QUIET.fin_area, fin_centre=2 * QUIET.fin_centre, fin_normal=1.0)
    assert read(at_rest(1.0), parameters=larger).fin_load == pytest.approx(2 * 8 / 2)
