"""The hull's motion against analytic results, and against the textbook's matrices."""

from dataclasses import replace
from itertools import pairwise
from math import asin, atan2, cos, pi, sin, sqrt
from random import Random

import numpy as np
import pytest

from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.geometry import BodyState, normalize, rotation, to_body, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Six, Vector
from robot_runtime.simulation.water.surroundings import Current
from tests.runtime.simulation.water.harness import NEUTRAL, STILL, UNDAMPED, drift, pushed
from tests.runtime.simulation.water.reference import acceleration
from tests.runtime.simulation.water.reference import rotation as reference_rotation

AXES = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def single(axis: int, value: float) -> Six:
    values = [0.0] * 6
    values[axis] = value
    a, b, c, d, e, f = values
    return a, b, c, d, e, f


def some_vector(random: Random, size: float) -> Vector:
    return random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)


def some_state(random: Random) -> BodyState:
    w, x, y, z = (random.gauss(0, 1) for _ in range(4))
    return BodyState(
        (0.0, 0.0, 50.0), normalize((w, x, y, z)), some_vector(random, 0.5), some_vector(random, 3.0)
    )


def energy(body: Body, parameters: SimulationParameters) -> float:
    """Kinetic, of hull and added mass, and potential, of weight and buoyancy, in J; neutral buoyancy."""
    _, attitude, velocity, rate = body.state
    kinetic = 0.5 * sum(
        mass * speed**2 for mass, speed in zip(parameters.total_mass, (*velocity, *rate), strict=True)
    )
    righting = -parameters.weight * parameters.buoyancy_height * rotation(attitude)[2][2]
    return kinetic + righting


def test_acceleration_equals_the_textbook_matrices() -> None:
    random = Random(7)
    for _ in range(50):
        wrench: Six = (*some_vector(random, 2.0), *some_vector(random, 0.2))
        parameters = SimulationParameters(floor=1000.0)
        body = pushed(parameters, wrench)
        current = some_vector(random, 0.5)
        body.world.set_current(Current(*current))
        state = some_state(random)
        got = body.derivative(state, STILL, STILL)
        expected = acceleration(parameters, state, current, wrench)
        assert (*got.velocity, *got.rate) == pytest.approx(tuple(expected), rel=1e-9, abs=1e-9)


def test_rotation_equals_rodrigues_and_is_undone() -> None:
    random = Random(3)
    for _ in range(20):
        state = some_state(random)
        matrix = rotation(state.attitude)
        for row, expected in zip(matrix, reference_rotation(np.array(state.attitude)), strict=True):
            assert row == pytest.approx(tuple(expected), abs=1e-12)
        vector = some_vector(random, 2.0)
        assert to_body(matrix, to_world(matrix, vector)) == pytest.approx(vector, abs=1e-12)


@pytest.mark.parametrize("axis", range(6), ids=AXES)
def test_initial_acceleration_is_force_over_mass_with_added_mass(axis: int) -> None:
    body = pushed(NEUTRAL, single(axis, 0.3))
    rates = body.derivative(body.state, STILL, STILL)
    own = (NEUTRAL.mass, NEUTRAL.mass, NEUTRAL.mass, *NEUTRAL.inertia)[axis]
    expected = single(axis, 0.3 / (own + NEUTRAL.added_mass[axis]))
    assert (*rates.velocity, *rates.rate) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("axis", range(3), ids=AXES[:3])
def test_terminal_speed_is_the_quadratic_root(axis: int) -> None:
    force, linear, quadratic = 0.5, NEUTRAL.damping_linear[axis], NEUTRAL.damping_quadratic[axis]
    expected = (-linear + sqrt(linear**2 + 4 * quadratic * force)) / (2 * quadratic)
    # Held from turning, as the hull has no keel: the Munk moment would turn it across its path.
    stiff = replace(NEUTRAL, inertia=(1e9, 1e9, 1e9))
    state = drift(pushed(stiff, single(axis, force)), 60, 0.01)
    assert state.velocity[axis] == pytest.approx(expected, rel=1e-6)


def test_neutral_hull_hovers() -> None:
    state = drift(pushed(NEUTRAL), 60, 0.01)
    assert state.position == pytest.approx((0, 0, 100), abs=1e-9)
    assert state.attitude == (1, 0, 0, 0)


def test_buoyant_hull_rises_at_the_computed_speed() -> None:
    parameters = SimulationParameters(floor=1000.0)
    net = parameters.weight * (parameters.buoyancy - 1)
    linear, quadratic = parameters.damping_linear[2], parameters.damping_quadratic[2]
    expected = (-linear + sqrt(linear**2 + 4 * quadratic * net)) / (2 * quadratic)
    body = pushed(parameters)
    before = drift(body, 60, 0.01).position[2]
    after = drift(body, 10, 0.01).position[2]
    assert before - after == pytest.approx(10 * expected, rel=1e-6)


@pytest.mark.parametrize(("axis", "period"), [(0, 1.0988), (1, 1.9689)], ids=["roll", "pitch"])
def test_pendulum_periods(axis: int, period: float) -> None:
    total = UNDAMPED.inertia[axis] + UNDAMPED.added_mass[3 + axis]
    analytic = 2 * pi * sqrt(total / (UNDAMPED.weight * UNDAMPED.buoyancy_height))
    assert analytic == pytest.approx(period, rel=1e-3)
    body = pushed(UNDAMPED)
    tilt = [0.0, 0.0, 0.0]
    tilt[axis] = sin(0.01)
    body.state = body.state._replace(attitude=(cos(0.01), tilt[0], tilt[1], tilt[2]))
    rates = []
    for _ in range(5000):
        body.step(0.002, STILL, STILL)
        rates.append(body.state.rate[axis])
    turns = [
        index + early / (early - late)
        for index, (early, late) in enumerate(pairwise(rates))
        if early < 0 <= late
    ]
    measured = 0.002 * (turns[-1] - turns[0]) / (len(turns) - 1)
    assert len(turns) >= 4
    assert measured == pytest.approx(analytic, rel=1e-3)


def tumbling(parameters: SimulationParameters) -> Body:
    body = pushed(parameters)
    tilted = normalize((1.0, 0.3, -0.2, 0.1))
    body.state = BodyState((0, 0, 100), tilted, (0.2, -0.1, 0.15), (0.5, -0.8, 0.3))
    return body


def test_without_damping_energy_stays() -> None:
    body = tumbling(UNDAMPED)
    floor = -UNDAMPED.weight * UNDAMPED.buoyancy_height
    start = energy(body, UNDAMPED) - floor
    worst = 0.0
    for _ in range(2500):
        body.step(0.002, STILL, STILL)
        worst = max(worst, abs(energy(body, UNDAMPED) - floor - start) / start)
    assert worst < 1e-3


def test_damping_only_takes_energy() -> None:
    body = tumbling(NEUTRAL)
    energies = [energy(body, NEUTRAL)]
    for _ in range(2500):
        body.step(0.002, STILL, STILL)
        energies.append(energy(body, NEUTRAL))
    assert all(late <= early + 1e-12 for early, late in pairwise(energies))
    assert energies[-1] < 0.2 * energies[0] or energies[-1] < 0


def test_hull_drifts_with_the_current() -> None:
    body = pushed(NEUTRAL)
    current = (0.3, -0.2, 0.1)
    body.world.set_current(Current(*current))
    state = drift(body, 120, 0.01)
    assert to_world(rotation(state.attitude), state.velocity) == pytest.approx(current, abs=1e-3)


def test_a_current_carries_every_motion_along_unchanged() -> None:
    """Galilei: motion in a steady current, in the current's frame, equals the motion in still water."""
    current = (0.3, -0.2, 0.1)
    still, carried = tumbling(NEUTRAL), tumbling(NEUTRAL)
    carried.world.set_current(Current(*current))
    x, y, z = to_world(rotation(still.state.attitude), still.state.velocity)
    moving = (x + current[0], y + current[1], z + current[2])
    carried.state = carried.state._replace(velocity=to_body(rotation(still.state.attitude), moving))
    alone, along = drift(still, 5, 0.001), drift(carried, 5, 0.001)
    offset = [late - early for early, late in zip(alone.position, along.position, strict=True)]
    assert offset == pytest.approx([5 * speed for speed in current], abs=1e-4)
    assert along.attitude == pytest.approx(alone.attitude, abs=1e-4)


def test_munk_moment_turns_a_drifting_hull_across_its_path() -> None:
    body = pushed(NEUTRAL)
    body.state = body.state._replace(velocity=(0.3, 0.05, 0.0))
    # N = (M_surge - M_sway) u v, negative here: the bow turns away from the side to which the hull slips.
    surge, sway = NEUTRAL.total_mass[0], NEUTRAL.total_mass[1]
    expected = (surge - sway) * 0.3 * 0.05 / NEUTRAL.total_mass[5]
    assert expected < 0
    assert body.derivative(body.state, STILL, STILL).rate[2] == pytest.approx(expected)


def test_attitude_angles_have_the_signs_of_the_conventions() -> None:
    """Right side down, nose up and turning right are positive."""
    for axis, name in enumerate(AXES[3:]):
        state = drift(pushed(NEUTRAL, single(3 + axis, 0.01)), 0.2)
        matrix = rotation(state.attitude)
        roll, pitch, yaw = (
            atan2(matrix[2][1], matrix[2][2]),
            -asin(matrix[2][0]),
            atan2(matrix[1][0], matrix[0][0]),
        )
        angles = {"roll": roll, "pitch": pitch, "yaw": yaw}
        assert angles[name] > 0.001
        bow = to_world(matrix, (1.0, 0.0, 0.0))
        right = to_world(matrix, (0.0, 1.0, 0.0))
        assert {"roll": right[2] > 0, "pitch": bow[2] < 0, "yaw": bow[1] > 0}[name]
