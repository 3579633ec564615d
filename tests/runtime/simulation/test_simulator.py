"""The simulated robot as the board meets it: fins in, readings out."""

from itertools import pairwise
from math import inf, nan, pi

import pytest

from robot_runtime.simulation.fins import Four
from robot_runtime.simulation.parameters import Parameters
from robot_runtime.simulation.sensors import Reading
from robot_runtime.simulation.simulator import FinMotion, Simulator
from robot_runtime.simulation.surroundings import Current
from tests.runtime.simulation.harness import QUIET, STILL, Flapping

PERIOD = 0.005
UP = -pi / 2


def swim(simulator: Simulator, flapping: Flapping, seconds: float, drives: Four = STILL) -> list[Reading]:
    times = [(index + 1) * PERIOD for index in range(round(seconds / PERIOD))]
    return [
        simulator.advance(
            PERIOD, FinMotion(flapping.at(time), flapping.speeds_at(time), drives, powered=True)
        )
        for time in times
    ]


def rest(simulator: Simulator, seconds: float = PERIOD) -> Reading:
    return swim(simulator, Flapping(STILL, amplitude=0.0), seconds)[-1]


def depth(reading: Reading) -> float:
    return (reading.pressure - 101325) / 9810


def test_starts_at_rest_at_the_surface() -> None:
    reading = rest(Simulator(QUIET, seed=1), 1.0)
    assert reading.force == pytest.approx((0, 0, -9.81), abs=1e-6)
    assert reading.rate == pytest.approx((0, 0, 0), abs=1e-9)
    assert reading.pressure == 101325.0
    assert reading.temperature == 15.0
    assert reading.beacon_right
    assert reading.beacon_left


def test_dives_with_tips_up_and_floats_up_when_the_fins_rest() -> None:
    simulator = Simulator(QUIET, seed=1)
    dived = depth(swim(simulator, Flapping((UP,) * 4), 8)[-1])
    assert dived > 0.8
    assert depth(rest(simulator, 10)) < dived


def test_pressure_tells_the_true_depth() -> None:
    simulator = Simulator(QUIET, seed=1)
    reading = swim(simulator, Flapping((UP,) * 4), 3)[-1]
    # The sensor is on the back, 5 cm above the centre.
    assert depth(reading) == pytest.approx(simulator.truth().position[2] - 0.05, abs=1e-9)


def test_accelerometer_adds_up_to_the_speed_gained() -> None:
    simulator = Simulator(QUIET, seed=1)
    readings = swim(simulator, Flapping((UP,) * 4), 2)
    gained = sum((reading.force[2] + 9.81) * PERIOD for reading in readings)
    assert gained == pytest.approx(simulator.truth().velocity[2], abs=1e-3)
    assert gained > 0.05


def test_same_seed_same_run() -> None:
    def run(seed: int) -> tuple[list[Reading], object]:
        simulator = Simulator(Parameters(), seed)
        return swim(simulator, Flapping((UP, UP, 0, 0)), 1), simulator.truth()

    assert run(3) == run(3)
    assert run(3)[0] != run(4)[0]
    assert run(3)[1] == run(4)[1]


def test_truth_shows_the_fins_of_the_last_line() -> None:
    simulator = Simulator(QUIET, seed=1)
    simulator.advance(PERIOD, FinMotion((0.1, 0.2, 0.3, 0.4), STILL, STILL, powered=True))
    assert simulator.truth().fins == (0.1, 0.2, 0.3, 0.4)


def test_a_long_period_is_cut_into_steps() -> None:
    one, many = Simulator(QUIET, seed=1), Simulator(QUIET, seed=1)
    spin: Four = (1.0, -2.0, 3.0, -4.0)
    one.advance(0.05, FinMotion((0.05, -0.1, 0.15, -0.2), spin, STILL, powered=True))
    for index in range(1, 11):
        time = index * 0.005
        a, b, c, d = (speed * time for speed in spin)
        many.advance(0.005, FinMotion((a, b, c, d), spin, STILL, powered=True))
    assert one.truth().position == pytest.approx(many.truth().position, abs=1e-12)
    assert one.truth().attitude == pytest.approx(many.truth().attitude, abs=1e-12)


def test_reset_goes_back_to_the_start() -> None:
    simulator = Simulator(QUIET, seed=1)
    start = simulator.truth()
    swim(simulator, Flapping((UP, UP, UP, 0)), 3, drives=(63, 63, 63, 63))
    assert simulator.truth() != start
    simulator.reset()
    now = simulator.truth()
    assert (now.position, now.attitude, now.velocity, now.rate) == (
        start.position,
        start.attitude,
        start.velocity,
        start.rate,
    )
    assert rest(simulator).battery == pytest.approx(QUIET.battery_full, abs=1e-6)


def test_current_carries_the_robot() -> None:
    simulator = Simulator(QUIET, seed=1)
    simulator.set_current(Current(0.2, -0.1, 0.0))
    rest(simulator, 60)
    before = simulator.truth().position
    rest(simulator, 10)
    after = simulator.truth().position
    assert (after[0] - before[0]) / 10 == pytest.approx(0.2, abs=0.01)
    assert (after[1] - before[1]) / 10 == pytest.approx(-0.1, abs=0.01)


@pytest.mark.parametrize(
    "wrong", [(nan, 0, 0), (0, nan, 0), (0, 0, inf), (1.5, 1.5, 0), (-2.1, 0, 0), (10**400, 0, 0)]
)
def test_impossible_current_is_refused(wrong: tuple[float, float, float]) -> None:
    simulator = Simulator(QUIET, seed=1)
    with pytest.raises(ValueError, match="at most 2 m/s"):
        simulator.set_current(Current(*wrong))
    rest(simulator, 1)
    assert simulator.truth().position[:2] == pytest.approx((0, 0), abs=1e-9)


def test_strongest_current_is_taken() -> None:
    simulator = Simulator(QUIET, seed=1)
    simulator.set_current(Current(0.0, -2.0, 0.0))
    rest(simulator, 10)
    assert simulator.truth().position[1] < -5


def test_battery_drains_faster_while_the_motors_are_driven() -> None:
    def loss(drives: Four, powered: bool) -> float:
        simulator = Simulator(QUIET, seed=1)
        for _ in range(200):
            reading = simulator.advance(PERIOD, FinMotion(STILL, STILL, drives, powered))
        return (QUIET.battery_full - reading.battery) * 3600

    assert loss(STILL, powered=True) == pytest.approx(0.1)
    assert loss((63, -63, 63, -63), powered=True) == pytest.approx(1.1)
    assert loss((63, 0, -63, 0), powered=True) == pytest.approx(0.6)
    assert loss((63, 63, 63, 63), powered=False) == pytest.approx(0.1)


def test_bang_bang_control_ends_in_a_limit_cycle() -> None:
    """Full force towards 0.5 m at 10 Hz, from depth in steps of 1 cm, swings about the set point for good."""
    simulator = Simulator(QUIET, seed=1)
    down, up = Flapping((UP,) * 4), Flapping((-UP,) * 4)
    chosen, depths, pushes = down, [], []
    for index in range(round(60 / PERIOD)):
        time = (index + 1) * PERIOD
        motion = FinMotion(chosen.at(time), chosen.speeds_at(time), STILL, powered=True)
        depths.append(depth(simulator.advance(PERIOD, motion)))
        if (index + 1) % 20 == 0:
            chosen = down if round(depths[-1], 2) < 0.5 else up
            pushes.append(chosen is down)
    late = depths[round(30 / PERIOD) :]
    assert sum(late) / len(late) == pytest.approx(0.5, abs=0.05)
    assert 0.02 < max(late) - min(late) < 0.3
    turns = sum(early != later for early, later in pairwise(pushes[300:]))
    assert turns >= 10
