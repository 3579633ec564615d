"""Floor and walls: the hull stays inside, and no energy is gained."""

from dataclasses import replace
from math import sqrt
from random import Random

import pytest

from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.geometry import BodyState, normalize, rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Basin, Trim
from robot_runtime.simulation.water.world import World
from tests.runtime.simulation.water.harness import STILL, UNDAMPED, Flapping, drift, finned, pushed

POOL = Basin(depth=2.0, length=4.0, width=3.0)
WELL = Basin(depth=100.0, length=1.0, width=1.0)
"""So deep that the surface plays no part."""
HALF = (0.12, 0.065, 0.05)


def reach(state: BodyState, axis: int) -> float:
    """m from the centre to the hull's outermost point along a world axis."""
    return sqrt(
        sum((half * part) ** 2 for half, part in zip(HALF, rotation(state.attitude)[axis], strict=True))
    )


def outside(state: BodyState, basin: Basin) -> float:
    """m by which the hull penetrates floor or walls."""
    north, east, down = state.position
    beyond = [down + reach(state, 2) - basin.depth]
    if basin.length is not None and basin.width is not None:
        beyond += [abs(north) + reach(state, 0) - basin.length / 2]
        beyond += [abs(east) + reach(state, 1) - basin.width / 2]
    return max(beyond)


def energy(body: Body, parameters: SimulationParameters) -> float:
    """Kinetic energy with the added mass, and potential energy of a hull deep under water, in J."""
    position, attitude, velocity, rate = body.state
    kinetic = 0.5 * sum(
        mass * speed**2 for mass, speed in zip(parameters.total_mass, (*velocity, *rate), strict=True)
    )
    weight, lift = parameters.weight, parameters.weight * parameters.buoyancy
    above = position[2] - parameters.buoyancy_height * rotation(attitude)[2][2]
    return kinetic - weight * position[2] + lift * above


def thrown(random: Random, parameters: SimulationParameters) -> Body:
    body = pushed(parameters)
    body.world.set_basin(WELL)
    w, x, y, z = (random.gauss(0, 1) for _ in range(4))
    speeds = [random.uniform(-1.5, 1.5) for _ in range(6)]
    body.state = BodyState(
        (random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 99.5),
        normalize((w, x, y, z)),
        (speeds[0], speeds[1], abs(speeds[2])),
        (3 * speeds[3], 3 * speeds[4], 3 * speeds[5]),
    )
    return body


@pytest.mark.parametrize("restitution", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.3, 5.0])
def test_a_thrown_hull_stays_inside_and_gains_no_energy(restitution: float, friction: float) -> None:
    """Without damping, which would hide a gain of energy."""
    parameters = replace(UNDAMPED, buoyancy=0.97, floor=3.0, restitution=restitution, friction=friction)
    random = Random(5)
    for _ in range(6):
        body = thrown(random, parameters)
        start = energy(body, parameters)
        moving = start - energy_at_rest(parameters)
        highest = 0.0
        touches, worst = 0, 0.0
        for _ in range(2000):
            body.step(0.002, STILL, STILL)
            touches += outside(body.state, WELL) > -5e-4
            worst = max(worst, outside(body.state, WELL))
            highest = max(highest, energy(body, parameters) - start)
        assert touches > 1
        assert worst < 1e-3
        # The integration alone may gain as much; see test_without_damping_energy_stays.
        assert highest < 1e-3 * moving


def energy_at_rest(parameters: SimulationParameters) -> float:
    """Energy in J of a hull that lies on the floor."""
    body = pushed(parameters, depth=WELL.depth - HALF[2])
    return energy(body, parameters)


def test_lies_on_the_floor_and_stays() -> None:
    heavy = SimulationParameters(buoyancy=0.99)
    body = pushed(heavy, depth=2.5)
    drift(body, 20, 0.005)
    there = body.state
    assert there.position[2] == pytest.approx(2.95, abs=1e-9)
    later = drift(body, 60, 0.005)
    assert later.position == pytest.approx(there.position, abs=1e-9)
    assert later.attitude == pytest.approx(there.attitude, abs=1e-9)


def test_an_ill_trimmed_hull_tilts_on_the_floor_and_stays() -> None:
    body = pushed(SimulationParameters(), depth=2.5)
    body.trim = Trim(0.98, 0.004, 0.003, 0.01)
    drift(body, 60, 0.005)
    there = body.state
    later = drift(body, 60, 0.005)
    assert later.position == pytest.approx(there.position, abs=1e-4)
    assert later.attitude == pytest.approx(there.attitude, abs=1e-3)
    assert outside(later, Basin(3.0)) == pytest.approx(0, abs=1e-5)
    assert abs(later.attitude[1]) > 0.01


def test_leaves_the_floor_when_it_is_pushed_up() -> None:
    lifted = pushed(SimulationParameters(), (0, 0, -0.5, 0, 0, 0), depth=2.95)
    assert drift(lifted, 2, 0.005).position[2] < 2.9


@pytest.mark.parametrize(("axis", "side"), [(0, 1), (0, -1), (1, 1), (1, -1), (2, 1)])
def test_comes_back_with_its_share_of_the_speed(axis: int, side: int) -> None:
    body = pushed(UNDAMPED)
    body.world.set_basin(POOL)
    position, speed = [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]
    limit = (POOL.length or 0) / 2, (POOL.width or 0) / 2, POOL.depth
    position[axis] = side * (limit[axis] - HALF[axis] - 0.0001)
    speed[axis] = side * 0.3
    body.state = body.state._replace(
        position=(position[0], position[1], position[2]), velocity=(speed[0], speed[1], speed[2])
    )
    body.step(0.002, STILL, STILL)
    assert body.state.velocity[axis] == pytest.approx(-side * 0.2 * 0.3)
    assert outside(body.state, POOL) == pytest.approx(0, abs=1e-12)


def test_friction_takes_its_share_of_the_blow() -> None:
    """Without rotation: Δu = -µ·(1+e)·w·m_heave / m_surge."""
    stiff = replace(UNDAMPED, floor=3.0, inertia=(1e9, 1e9, 1e9))
    body = pushed(stiff, depth=2.95)
    body.state = body.state._replace(velocity=(0.5, 0.0, 0.1))
    body.step(0.0001, STILL, STILL)
    total = stiff.total_mass
    expected = 0.5 - 0.3 * 1.2 * 0.1 * total[2] / total[0]
    assert body.state.velocity[0] == pytest.approx(expected, rel=1e-3)
    body.state = body.state._replace(position=(0, 0, 2.95), velocity=(0.01, 0.0, 0.1))
    body.step(0.0001, STILL, STILL)
    assert body.state.velocity[0] == pytest.approx(0, abs=1e-6)


def test_a_blow_to_the_bow_turns_the_hull() -> None:
    body = pushed(UNDAMPED)
    body.world.set_basin(POOL)
    attitude = normalize((1.0, 0.0, 0.0, 0.3))
    x, y, z = to_world(rotation(attitude), (0.3, 0.0, 0.0))
    body.state = BodyState((1.85, 0.0, 1.0), attitude, (0.3, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert x > 0.2
    assert (abs(y), z) == (pytest.approx(0.169, abs=0.01), 0)
    drift(body, 0.3, 0.002)
    # The bow, on the right of its way, is thrown on to the right.
    assert body.state.rate[2] > 0.1


def test_swims_against_the_wall_and_stays_inside() -> None:
    body = finned(SimulationParameters(), 1.0)
    body.world.set_basin(Basin(depth=2.0, length=2.0, width=2.0))
    flapping = Flapping(STILL, fins=(0, 3))
    for second in range(20):
        state = flapping.swim(body, 1.0, start=second)
        assert outside(state, body.world.basin) < 1e-3
    assert max(abs(state.position[0]), abs(state.position[1])) > 0.6


def test_open_water_has_no_walls() -> None:
    body = pushed(UNDAMPED)
    body.state = body.state._replace(velocity=(1.0, 0.0, 0.0), position=(0.0, 0.0, 1.0))
    body.world.set_basin(Basin(2.0))
    assert drift(body, 20, 0.01).position[0] == pytest.approx(20)


def test_world_knows_its_floor_from_the_parameters() -> None:
    assert World(SimulationParameters(floor=7.0)).basin == Basin(7.0)
