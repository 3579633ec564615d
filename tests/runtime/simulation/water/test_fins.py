"""The fins: their mean thrust, and the direction of each degree of freedom."""

from dataclasses import replace
from math import cos, pi
from random import Random

import pytest

from robot_runtime.simulation.water.fins import FinDelay, Fins, Four
from robot_runtime.simulation.water.geometry import rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Six
from tests.runtime.simulation.water.harness import NEUTRAL, STILL, Flapping, finned
from tests.runtime.simulation.water.reference import fin_wrench

AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
UP, DOWN = -pi / 2, pi / 2
AWAY = pi
"""rad: the tip on the other side of its shaft, forward for the front fins and aft for the back fins."""
SWIMMING: Four = (pi, 0.0, 0.0, pi)
"""Phases as the firmware has them."""
FRONT, BACK, ALL = (0, 3), (1, 2), (0, 1, 2, 3)


def published_thrust(drag: float, amplitude: float, frequency: float) -> float:
    """Mean thrust (N) of one fin: 8ρ·C_d·S·r_c²·π²f²·(1 - cos A)."""
    return 8 * 1000 * drag * 0.0045 * 0.045**2 * pi**2 * frequency**2 * (1 - cos(amplitude))


def mean_push(parameters: SimulationParameters, flapping: Flapping) -> Six:
    """Mean wrench over one period on a fixed hull."""
    fins, count = Fins(parameters), 2000
    times = [index * 2 * pi / flapping.omega / count for index in range(count)]
    pushes = [fins.push(flapping.at(time), flapping.speeds_at(time), *AT_REST) for time in times]
    a, b, c, d, e, f = (sum(parts) / count for parts in zip(*pushes, strict=True))
    return a, b, c, d, e, f


def test_push_equals_the_vector_form() -> None:
    random = Random(11)
    for _ in range(50):
        a, b, c, d, e, f, g, h = (random.uniform(-10, 10) for _ in range(8))
        u, v, w, p, q, r = (random.uniform(-1, 1) for _ in range(6))
        got = Fins(NEUTRAL).push((a, b, c, d), (e, f, g, h), (u, v, w), (p, q, r))
        expected = fin_wrench(NEUTRAL, (a, b, c, d), (e, f, g, h), (u, v, w), (p, q, r))
        assert got == pytest.approx(tuple(expected), rel=1e-9, abs=1e-9)


def test_thrust_coefficient_follows_from_the_published_formula() -> None:
    parameters = replace(NEUTRAL, fin_drag=0.15)
    assert parameters.thrust_coefficient == pytest.approx(2.09, abs=0.005)
    assert NEUTRAL.thrust_coefficient == pytest.approx(2.09 * 0.31 / 0.15, rel=2e-3)


@pytest.mark.parametrize("amplitude", [0.2, 0.8, 1.2, 1.6])
@pytest.mark.parametrize("frequency", [0.5, 1.3, 2.0])
@pytest.mark.parametrize("drag", [0.15, 0.31])
def test_mean_thrust_is_the_published_one(amplitude: float, frequency: float, drag: float) -> None:
    flapping = Flapping(STILL, amplitude=amplitude, frequency=frequency, fins=FRONT)
    forward = mean_push(replace(NEUTRAL, fin_drag=drag), flapping)[0]
    along_mount = forward / (2 * cos(pi / 6))
    assert along_mount == pytest.approx(published_thrust(drag, amplitude, frequency), rel=0.15)


def test_mean_thrust_is_exact_where_it_was_calibrated() -> None:
    forward = mean_push(NEUTRAL, Flapping(STILL, amplitude=1.6, frequency=1.3, fins=FRONT))[0]
    assert forward == pytest.approx(2 * cos(pi / 6) * published_thrust(0.31, 1.6, 1.3), rel=1e-3)
    assert forward == pytest.approx(0.67, abs=0.01)


@pytest.mark.parametrize(
    ("zeros", "fins", "axis", "sign"),
    [
        (STILL, FRONT, 0, +1),
        (STILL, BACK, 0, -1),
        (STILL, (2, 3), 1, +1),
        (STILL, (0, 1), 1, -1),
        ((UP, UP, UP, UP), ALL, 2, +1),
        ((DOWN, DOWN, DOWN, DOWN), ALL, 2, -1),
        ((UP, UP, DOWN, DOWN), ALL, 3, +1),
        ((DOWN, DOWN, UP, UP), ALL, 3, -1),
        ((DOWN, UP, UP, DOWN), ALL, 4, +1),
        ((UP, DOWN, DOWN, UP), ALL, 4, -1),
        ((AWAY, 0, AWAY, 0), ALL, 5, +1),
        ((0, AWAY, 0, AWAY), ALL, 5, -1),
    ],
    ids=[
        *("forwards", "backwards", "right", "left", "down", "up"),
        *("right side down", "left side down", "nose up", "nose down", "turn right", "turn left"),
    ],
)
def test_each_degree_of_freedom_is_pushed_alone(
    zeros: Four, fins: tuple[int, ...], axis: int, sign: int
) -> None:
    push = mean_push(NEUTRAL, Flapping(zeros, fins=fins))
    assert sign * push[axis] > (0.3 if axis < 3 else 0.02)
    forces, torques = push[:3], push[3:]
    group = forces if axis < 3 else torques
    assert all(abs(part) < 1e-9 for index, part in enumerate(group) if index != axis % 3)


def test_swims_forward_at_the_expected_speed() -> None:
    body = finned()
    flapping = Flapping(STILL, SWIMMING, fins=FRONT)
    start = flapping.swim(body, 20).position[0]
    end = flapping.swim(body, 10, start=20).position[0]
    assert (end - start) / 10 == pytest.approx(0.22, abs=0.03)


def test_dives_at_the_expected_speed_with_tips_up() -> None:
    body = finned()
    flapping = Flapping((UP, UP, UP, UP), SWIMMING)
    start = flapping.swim(body, 20).position[2]
    end = flapping.swim(body, 10, start=20).position[2]
    assert (end - start) / 10 == pytest.approx(0.18, abs=0.03)


def test_rises_with_tips_down() -> None:
    state = Flapping((DOWN, DOWN, DOWN, DOWN), SWIMMING).swim(finned(), 5)
    assert state.position[2] < 99.6


def test_turns_right_on_the_spot() -> None:
    state = Flapping((AWAY, 0, AWAY, 0)).swim(finned(), 1.5)
    bow = to_world(rotation(state.attitude), (1.0, 0.0, 0.0))
    assert bow[1] > 0.1
    assert abs(state.position[0]) < 0.02
    assert abs(state.position[1]) < 0.02


def test_a_fixed_fin_has_drag_in_cross_flow() -> None:
    push = Fins(NEUTRAL).push(STILL, STILL, (0.0, 0.0, 0.4), (0.0, 0.0, 0.0))
    expected = -4 * 0.5 * 1000 * 2.0 * 0.0045 * 0.4**2
    assert push[2] == pytest.approx(expected)
    assert Fins(NEUTRAL).push(STILL, STILL, (0.4, 0.0, 0.0), (0.0, 0.0, 0.0))[0] == 0


def test_smaller_steps_converge() -> None:
    """Convergence of second order: a quarter of the step, about a sixteenth of the error."""

    def swim(duration: float) -> float:
        return Flapping((UP, UP, UP, UP), SWIMMING).swim(finned(), 10, duration).position[2]

    exact = swim(0.0005)
    coarse, fine = abs(swim(0.005) - exact), abs(swim(0.00125) - exact)
    assert coarse < 1e-4
    assert fine < coarse / 8


def test_the_water_answers_a_delayed_fin_later() -> None:
    delay = FinDelay(0.012)
    motions = [(0.005 * step, 0.3 * 0.005 * step) for step in range(1, 9)]
    answered = [delay.delay(0.005, (angle, 0.0, 0.0, 0.0), (0.3, 0.0, 0.0, 0.0)) for _, angle in motions]
    # Before the first period it was at rest where that began.
    expected = [0.3 * max(time - 0.012, 0.0) for time, _ in motions]
    assert [angles[0] for angles, _ in answered] == pytest.approx(expected)
    # In the third period it begins to turn after 0.002 s.
    assert [speeds[0] for _, speeds in answered] == pytest.approx([0.0, 0.0, 0.18, *[0.3] * 5])


def test_a_delayed_fin_turns_on_where_its_encoder_begins_anew() -> None:
    delay = FinDelay(0.0125)
    angles = [(3.0 + 10 * 0.005 * step + pi) % (2 * pi) - pi for step in range(1, 21)]
    assert min(angles) < -3 < 3 < max(angles)
    speeds = [delay.delay(0.005, (angle,) * 4, (10.0,) * 4)[1][2] for angle in angles]
    assert speeds[4:] == pytest.approx([10.0] * 16)
