"""Airy's waves: against their equations, and their effects on the hull."""

from dataclasses import replace
from math import cos, exp, pi, tanh

import pytest

from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import Basin, Current, Waves
from robot_runtime.simulation.water.world import World
from tests.runtime.simulation.water.harness import NEUTRAL, STILL, pushed

DEEP = Waves(amplitude=0.1, period=2.0, direction=0.0)
DEEP_NUMBER = (2 * pi / 2.0) ** 2 / 9.81
"""rad/m, of such a wave in deep water."""
SMALL = 1e-5


def waving(waves: Waves, depth: float = 1000.0) -> World:
    world = World(SimulationParameters())
    world.set_basin(Basin(depth))
    world.set_waves(waves)
    return world


def slope(world: World, what: str, axis: int, position: Vector, time: float) -> float:
    """Central difference of pressure or of a velocity (north, down) along an axis; axis 3 is time."""
    values = []
    for side in (SMALL, -SMALL):
        at = [*position, time]
        at[axis] += side
        here: Vector = (at[0], at[1], at[2])
        velocity = world.flow(at[3], here).velocity
        known = {"pressure": world.pressure(at[3], here), "north": velocity[0], "down": velocity[2]}
        values.append(known[what])
    return (values[0] - values[1]) / (2 * SMALL)


@pytest.mark.parametrize(
    ("period", "depth"), [(2.0, 1000.0), (2.0, 3.0), (5.0, 3.0), (30.0, 1.0), (0.8, 0.5), (30.0, 1000.0)]
)
def test_length_follows_from_period_and_depth(period: float, depth: float) -> None:
    world = waving(Waves(0.001, period, 0.0), depth)
    # Surface height at the crest, and where along its path it is a quarter of a length later.
    low, high = 0.0, 2.0 * pi * 9.81 * period**2
    for _ in range(100):
        middle = (low + high) / 2
        frequency = 2 * pi / period
        low, high = (middle, high) if 9.81 * middle * tanh(middle * depth) < frequency**2 else (low, middle)
    for part in (0.0, 0.25, 0.5, 1.0):
        rise = world.flow(0.0, (part * 2 * pi / low, 0.0, 0.1)).rise
        assert rise == pytest.approx(0.001 * cos(2 * pi * part), abs=1e-9)


@pytest.mark.parametrize("depth", [1000.0, 3.0, 1.0])
@pytest.mark.parametrize("down", [0.05, 0.4, 0.9])
@pytest.mark.parametrize("time", [0.0, 0.3, 1.1])
def test_flow_solves_the_linear_equations(depth: float, down: float, time: float) -> None:
    """Continuity, and Newton's law of the water: acceleration from pressure gradient and gravity."""
    world = waving(replace(DEEP, amplitude=1e-4), depth)
    position = (0.7, -0.4, down)
    flow = world.flow(time, position)
    assert slope(world, "north", 0, position, time) == pytest.approx(-slope(world, "down", 2, position, time))
    ahead, _, under = flow.acceleration
    assert ahead == pytest.approx(-slope(world, "pressure", 0, position, time) / 1000, abs=1e-6)
    assert under == pytest.approx(9.81 - slope(world, "pressure", 2, position, time) / 1000, abs=1e-6)


@pytest.mark.parametrize("depth", [1000.0, 3.0, 1.0])
@pytest.mark.parametrize("time", [0.0, 0.3, 1.1])
@pytest.mark.parametrize("direction", [0.0, 2.0])
def test_acceleration_is_that_of_the_water_on_its_way(depth: float, time: float, direction: float) -> None:
    world = waving(replace(DEEP, direction=direction), depth)
    world.set_current(Current(0.3, -0.1, 0.05, turning=0.2))
    position = (0.7, -0.4, 0.3)
    flow = world.flow(time, position)
    sides = []
    for step in (SMALL, -SMALL):
        x, y, z = (at + speed * step for at, speed in zip(position, flow.velocity, strict=True))
        sides.append(world.flow(time + step, (x, y, z)).velocity)
    expected = [(late - early) / (2 * SMALL) for late, early in zip(*sides, strict=True)]
    assert flow.acceleration == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_surface_moves_with_the_water_and_the_floor_lets_none_through() -> None:
    world = waving(DEEP, 3.0)
    for time in (0.0, 0.4, 1.3):
        rising = (world.flow(time + SMALL, STILL[:3]).rise - world.flow(time - SMALL, STILL[:3]).rise) / (
            2 * SMALL
        )
        assert -world.flow(time, (0.0, 0.0, 0.0)).velocity[2] == pytest.approx(rising, abs=1e-6)
        assert world.flow(time, (0.0, 0.0, 3.0)).velocity[2] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("depth", [0.5, 1.0, 2.0, 5.0])
def test_deep_waves_decay_exponentially(depth: float) -> None:
    world = waving(DEEP)
    decay = exp(-DEEP_NUMBER * depth)
    position = (0.0, 0.0, depth)
    assert world.flow(0.0, position).velocity[0] == pytest.approx(0.1 * pi * decay, rel=1e-6)
    assert world.flow(0.5, position).velocity[2] == pytest.approx(0.1 * pi * decay, rel=1e-6)
    still = 101325 + 9810 * depth
    assert world.pressure(0.0, position) - still == pytest.approx(9810 * 0.1 * decay, rel=1e-6)


def test_pressure_under_a_crest_is_that_of_the_water_above_and_in_the_air_none() -> None:
    world = waving(DEEP)
    assert world.pressure(0.0, (0.0, 0.0, -0.04)) == pytest.approx(101325 + 9810 * 0.06)
    assert world.pressure(0.0, (0.0, 0.0, -0.11)) == 101325
    assert world.pressure(1.0, (0.0, 0.0, 0.05)) == 101325


def test_waves_travel_in_the_given_direction() -> None:
    world = waving(Waves(0.1, 2.0, pi / 2))
    number = DEEP_NUMBER
    beside = world.flow(0.0, (1.0, 0.0, 0.5))
    assert beside.velocity == pytest.approx(world.flow(0.0, (0.0, 0.0, 0.5)).velocity, abs=1e-12)
    later = world.flow(0.5, (0.0, pi / 2 / number, 0.5))
    assert later.rise == pytest.approx(0.1)
    assert later.velocity[1] == pytest.approx(0.1 * pi * exp(-number * 0.5), rel=1e-6)
    assert later.velocity[0] == pytest.approx(0, abs=1e-9)


def test_current_and_waves_add_up() -> None:
    world = waving(DEEP)
    alone = world.flow(0.3, (0.2, 0.1, 0.5)).velocity
    world.set_current(Current(0.2, -0.1, 0.05))
    both = world.flow(0.3, (0.2, 0.1, 0.5)).velocity
    assert both == pytest.approx((alone[0] + 0.2, alone[1] - 0.1, alone[2] + 0.05))


def test_a_current_that_turns_from_north_to_east_reports_its_acceleration() -> None:
    world = World(SimulationParameters())
    world.set_current(Current(0.3, 0.0, 0.0, turning=0.1), time=7.0)
    position = (0.0, 0.0, 1.0)
    assert world.flow(7.0, position).velocity == pytest.approx((0.3, 0, 0))
    assert world.flow(7.0 + 5 * pi, position).velocity == pytest.approx((0, 0.3, 0), abs=1e-12)
    assert world.flow(7.0, position).acceleration == pytest.approx((0, 0.03, 0))


def floating_in(body: Body, waves: Waves, seconds: float) -> list[Vector]:
    """Positions every 5 ms of a hull that begins with the speed of the water."""
    body.world.set_waves(waves)
    body.state = body.state._replace(velocity=body.world.flow(0.0, body.state.position).velocity)
    places = []
    for _ in range(round(seconds / 0.005)):
        body.step(0.005, STILL, STILL)
        places.append(body.state.position)
    return places


def test_a_neutral_hull_circles_with_the_water() -> None:
    """Circles whose radius decays with depth, and the Stokes drift, a²ωk·e^(-2kz)."""
    waves, depth = Waves(0.05, 2.0, 0.0), 1.0
    body = pushed(NEUTRAL, depth=depth)
    periods = 5
    places = floating_in(body, waves, 2.0 * periods)
    radius = 0.05 * exp(-DEEP_NUMBER * depth)
    downs = [down for _, _, down in places]
    assert (max(downs) - min(downs)) / 2 == pytest.approx(radius, rel=0.02)
    drift = places[-1][0] / (2.0 * periods)
    stokes = 0.05**2 * pi * DEEP_NUMBER * exp(-2 * DEEP_NUMBER * depth)
    assert drift == pytest.approx(stokes, rel=0.1)


def test_waves_vanish_at_a_depth_of_one_wavelength() -> None:
    length = 2 * pi / DEEP_NUMBER
    places = floating_in(pushed(NEUTRAL, depth=length), DEEP, 6.0)
    assert max(abs(part) for north, _, down in places for part in (north, down - length)) < 0.1 * 0.005


def test_floating_hull_rides_on_long_waves() -> None:
    parameters = replace(SimulationParameters(), floor=1000.0)
    body = pushed(parameters, depth=World(parameters).floating_depth(1.003))
    floating = body.state.position[2]
    places = floating_in(body, Waves(0.2, 5.0, 0.0), 20.0)
    lows = [down - floating for _, _, down in places[1000:]]
    assert max(lows) == pytest.approx(0.2, rel=0.05)
    assert min(lows) == pytest.approx(-0.2, rel=0.05)


def test_without_amplitude_there_is_no_wave() -> None:
    calm, asked = pushed(NEUTRAL), pushed(NEUTRAL)
    asked.world.set_waves(DEEP)
    asked.world.set_waves(Waves(0.0, 2.0, 0.0))
    for body in (calm, asked):
        body.step(0.005, STILL, STILL)
    assert calm.state == asked.state


@pytest.mark.parametrize(
    ("waves", "depth"), [(Waves(0.5, 2.0, 0.0), 100.0), (Waves(0.3, 10.0, 0.0), 0.5), (Waves(0.08, 0.8), 5.0)]
)
def test_waves_that_would_break_are_refused(waves: Waves, depth: float) -> None:
    with pytest.raises(ValueError, match=r"break in water of .* is the most there"):
        waving(waves, depth)
    world = waving(replace(waves, amplitude=waves.amplitude / 3), depth)
    with pytest.raises(ValueError, match="break"):
        world.set_waves(waves)
    assert world.waves.amplitude == waves.amplitude / 3


def test_water_too_shallow_for_its_waves_is_refused() -> None:
    world = waving(Waves(0.3, 5.0, 0.0), 10.0)
    with pytest.raises(ValueError, match="break"):
        world.set_basin(Basin(0.5))
    assert world.basin == Basin(10.0)
