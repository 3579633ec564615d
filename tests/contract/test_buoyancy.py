"""Buoyancy in grams: published densities, and the simulated water's own rise and tilt."""

from dataclasses import replace
from math import asin, degrees

import pytest

from robot_runtime.contract.buoyancy import (
    buoyancy_reserve,
    reserve_elsewhere,
    rest_angle,
    rise_speed,
    rise_time,
    water_density,
)
from robot_runtime.contract.craft import Craft
from robot_runtime.simulation.water.geometry import rotation
from robot_runtime.simulation.water.parameters import SimulationParameters
from tests.runtime.simulation.water.harness import STILL, drift, pushed


@pytest.mark.parametrize(
    ("temperature", "salinity", "published"),
    [
        (5, 0, 999.96675),
        (25, 0, 997.04796),
        (5, 35, 1027.67547),
        (25, 35, 1023.34306),
        (10, 8, 1005.94659),
    ],
)
def test_density_is_the_published_one(temperature: float, salinity: float, published: float) -> None:
    """The check values of UNESCO's paper, and one of its Baltic range."""
    assert water_density(temperature, salinity) == pytest.approx(published, abs=2e-5)


@pytest.mark.parametrize(
    ("temperature", "measured"), [(4, 999.975), (10, 999.703), (20, 998.207), (30, 995.650), (40, 992.22)]
)
def test_density_of_pure_water_agrees_with_kell_s(temperature: float, measured: float) -> None:
    """Kell's equation of 1975 is the handbooks' table of pure water."""
    assert water_density(temperature) == pytest.approx(measured, abs=0.01)


@pytest.mark.parametrize(
    ("temperature", "salinity"), [(-1, 0), (41, 0), (20, -1), (20, 43), (float("nan"), 0)]
)
def test_water_outside_the_equation_is_refused(temperature: float, salinity: float) -> None:
    with pytest.raises(ValueError, match="no density of water is known"):
        water_density(temperature, salinity)


def test_warm_water_takes_the_default_craft_s_reserve() -> None:
    cold, warm = (buoyancy_reserve(Craft(), water_density(temperature)) for temperature in (10, 25))
    assert cold == pytest.approx(8.1, abs=0.05)
    assert warm == pytest.approx(0.1, abs=0.05)


@pytest.mark.parametrize("reserve", [3.0, 9.0, 30.0, 60.0])
def test_the_simulated_hull_rises_in_the_computed_time(reserve: float) -> None:
    craft = Craft(buoyancy=1 + reserve / 3000)
    body = pushed(SimulationParameters.of(craft), depth=2.0)
    while body.state.position[2] > 1.5:
        body.step(0.005, STILL, STILL)
    assert rise_time(craft, reserve, 0.5) == pytest.approx(body.time, abs=0.01)
    assert rise_time(craft, reserve, 100.0) == pytest.approx(100 / rise_speed(craft, reserve), rel=0.01)


@pytest.mark.parametrize(("reserve", "measured"), [(0.0, 21.8), (9.0, 21.4), (30.0, 19.7)])
def test_four_millimetres_tilt_the_simulated_hull_by_22_degrees(reserve: float, measured: float) -> None:
    """At rest by the formula; while it rises the flow takes a little of the angle."""
    craft = Craft(buoyancy=1 + reserve / 3000, buoyancy_forward=0.004)
    parameters = replace(SimulationParameters.of(craft), floor=1000.0)
    pitch = -asin(rotation(drift(pushed(parameters), 60, 0.01).attitude)[2][0])
    assert degrees(pitch) == pytest.approx(measured, abs=0.1)
    assert degrees(rest_angle(0.004, craft.buoyancy_height)) == pytest.approx(21.8, abs=0.05)


def test_a_weighed_reserve_is_carried_into_other_water() -> None:
    """The reserve elsewhere is that of a craft of the same volume in that water."""
    cold, sea = water_density(10), water_density(18, 35)
    craft = Craft(mass=2.8, buoyancy=1.012 * 1000 / cold)
    reserve = buoyancy_reserve(craft, cold)
    assert reserve == pytest.approx(33.6)
    assert reserve_elsewhere(2.8, reserve, cold, sea) == pytest.approx(buoyancy_reserve(craft, sea))
