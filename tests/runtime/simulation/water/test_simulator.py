"""The simulated robot as the board sees it: fins in, readings out."""

from itertools import pairwise
from math import copysign, inf, nan, pi, remainder, sin, sqrt
from statistics import stdev

import pytest

from robot_runtime.control.controllers.bang_bang import BangBang, BangBangDeadZone
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.controllers.pid import Pid
from robot_runtime.simulation.water.fins import Four
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.simulation.water.surroundings import Current
from tests.runtime.simulation.water.harness import QUIET, STILL, Flapping

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


def test_pressure_follows_the_true_depth() -> None:
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
        simulator = Simulator(SimulationParameters(), seed)
        return swim(simulator, Flapping((UP, UP, 0, 0)), 1), simulator.truth()

    assert run(3) == run(3)
    assert run(3)[0] != run(4)[0]
    assert run(3)[1] == run(4)[1]


def test_truth_shows_the_fins_of_the_last_line() -> None:
    simulator = Simulator(QUIET, seed=1)
    simulator.advance(PERIOD, FinMotion((0.1, 0.2, 0.3, 0.4), STILL, STILL, powered=True))
    assert simulator.truth().fins == (0.1, 0.2, 0.3, 0.4)


def test_a_long_period_is_cut_into_steps() -> None:
    single, many = Simulator(QUIET, seed=1), Simulator(QUIET, seed=1)
    spin: Four = (1.0, -2.0, 3.0, -4.0)
    single.advance(0.05, FinMotion((0.05, -0.1, 0.15, -0.2), spin, STILL, powered=True))
    for index in range(1, 11):
        time = index * 0.005
        a, b, c, d = (speed * time for speed in spin)
        many.advance(0.005, FinMotion((a, b, c, d), spin, STILL, powered=True))
    assert single.truth().position == pytest.approx(many.truth().position, abs=1e-12)
    assert single.truth().attitude == pytest.approx(many.truth().attitude, abs=1e-12)


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
        return (rest(Simulator(QUIET, seed=1), PERIOD).battery - reading.battery) * 1e6

    still = loss(STILL, powered=True)
    assert 0 < still < loss((30, 0, -30, 0), powered=True) < loss((63, -63, 63, -63), powered=True)
    assert loss((63, 63, 63, 63), powered=False) == pytest.approx(still)


def controlled(controller: Controller, seconds: float = 60.0) -> list[float]:
    """Depths every 5 ms of a robot that is steered at 10 Hz towards 0.5 m, by depth in steps of 1 cm.

    Its fins move as the firmware lets them: 80 ticks in 0.1 s for their direction, 0.12 s to their full
    amplitude, and motors of 12.6 rad/s.
    """
    simulator = Simulator(QUIET, seed=1)
    controller.start()
    direction = amplitude = expected = size = 0.0
    angles, depths = [0.0] * 4, list[float]()
    for index in range(1, round(seconds / PERIOD) + 1):
        direction += limited(wrapped(expected - direction), 80 * 2 * pi / 1024 / 0.1 * PERIOD)
        amplitude += limited(size - amplitude, 1.6 / 0.12 * PERIOD)
        speeds = []
        for fin, phase in enumerate((pi, 0.0, 0.0, pi)):
            goal = direction + amplitude / 2 * sin(2 * pi * 1.3 * index * PERIOD + phase)
            turn = limited(wrapped(goal - angles[fin]), 12.6 * PERIOD)
            angles[fin] += turn
            speeds.append(turn / PERIOD)
        a, b, c, d = angles
        e, f, g, h = speeds
        motion = FinMotion((a, b, c, d), (e, f, g, h), STILL, powered=True)
        depths.append(depth(simulator.advance(PERIOD, motion)))
        if index % 20 == 0:
            command = controller.step(0.5, round(depths[-1], 2), 0.1)
            size = 1.6 * abs(command)
            expected = copysign(UP, -command) if command else expected
    return depths


def limited(value: float, most: float) -> float:
    return min(max(value, -most), most)


def wrapped(angle: float) -> float:
    return remainder(angle, 2 * pi)


def deviation(depths: list[float]) -> tuple[float, float, float]:
    """RMSE from 0.5 m, peak to peak (m) and period (s) of the second half."""
    late = depths[len(depths) // 2 :]
    rmse = sqrt(sum((value - 0.5) ** 2 for value in late) / len(late))
    downs = [index for index, (early, later) in enumerate(pairwise(late)) if early < 0.5 <= later]
    return rmse, max(late) - min(late), PERIOD * (downs[-1] - downs[0]) / (len(downs) - 1)


def test_bang_bang_control_ends_in_the_limit_cycle_of_the_reference() -> None:
    """The experiment that the model was fitted to: RMSE 5 to 8 cm, 19 to 27 cm peak to peak with ±5 cm."""
    rmse, span, period = deviation(controlled(BangBangDeadZone()))
    assert 0.05 < rmse < 0.08
    assert 0.19 < span < 0.27
    assert 2 < period < 6


def test_bang_bang_without_dead_zone_oscillates_too_and_pid_less() -> None:
    rmse, span, period = deviation(controlled(BangBang()))
    assert 0.04 < rmse < 0.08
    assert 0.15 < span < 0.27
    assert 1.5 < period < 4
    assert deviation(controlled(Pid()))[0] < 0.6 * rmse


def test_the_noise_of_sensors_equals_their_parameters() -> None:
    simulator = Simulator(SimulationParameters(), seed=2)
    readings = [rest(simulator) for _ in range(2000)]
    depths = [depth(reading) for reading in readings]
    assert stdev(depths) == pytest.approx(42 / 9810, rel=0.1)
    assert stdev(reading.force[0] for reading in readings) == pytest.approx(1.7e-2, rel=0.1)
    assert stdev(reading.rate[0] for reading in readings) == pytest.approx(2e-4, rel=0.2)
    assert stdev(reading.encoders[0] for reading in readings) == pytest.approx(2.1e-3, rel=0.1)
    assert readings[-1].battery == pytest.approx(8.2, abs=0.1)
