"""Dead reckoning: its model of the hull, and the way that it publishes."""

from math import exp, pi
from random import Random

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.documents import Mode, Track
from robot_runtime.contract.packets import Imu, Motor
from robot_runtime.contract.topics import IMU, MOTOR, TRACK
from robot_runtime.control.dead_reckoning import GAP, DeadReckoning, Hull
from robot_runtime.simulation.water.fins import Fins
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.transport.bus import Bus

PERIOD = 0.02
STILL = (0.0, 0.0, 0.0)
NORTH, EAST = (1.0, 0.0, 0.0, 0.0), (0.70710678, 0.0, 0.0, 0.70710678)


class ReckoningRig:
    """Dead reckoning on a bus, with readings of fins that turn evenly, which pushes the hull forwards."""

    def __init__(self) -> None:
        self.bus, self.clock = Bus(), SimulatedClock()
        self.reckoning = DeadReckoning(self.bus, self.clock)
        self.tracks: list[Track] = []
        self.bus.on_row(TRACK, lambda _, record: self.tracks.append(Track.from_bytes(record)))
        self._swung = 0

    def swim(
        self,
        seconds: float,
        mode: Mode = "automatic",
        attitude: tuple[float, float, float, float] = NORTH,
        swing: float = 0.1,
        period: float = PERIOD,
    ) -> None:
        """Swing the front fins by `swing` rad each reading, there and back."""
        for _ in range(round(seconds / period)):
            self.clock.forward(period)
            now = self.clock.now()
            self._swung = (self._swung + 1) % 16
            angle = swing * (4 - abs(self._swung - 8))
            imu = Imu(time=0, attitude=attitude, rate=STILL, force=STILL)
            angles = (angle, 0.0, 0.0, angle)
            motor = Motor(time=0, wanted=angles, angle=angles, drive=(0, 0, 0, 0))
            self.bus.publish_row(IMU, now, imu.to_bytes())
            self.bus.publish_row(MOTOR, now, motor.to_bytes())
            self.reckoning.tick(mode)


def test_its_fins_push_as_the_water_of_the_simulator_says() -> None:
    draw = Random(1).uniform
    for _ in range(50):
        hull, fins = Hull(Craft()), Fins(SimulationParameters())
        hull.velocity = draw(-0.3, 0.3), draw(-0.3, 0.3), draw(-0.3, 0.3)
        a, b, c, d = (draw(-pi, pi) for _ in range(4))
        e, f, g, h = (draw(-9, 9) for _ in range(4))
        rate = draw(-2, 2), draw(-2, 2), draw(-2, 2)
        expected = fins.push((a, b, c, d), (e, f, g, h), hull.velocity, rate)[:3]
        assert hull._push((a, b, c, d), (e, f, g, h), rate) == pytest.approx(expected)


def test_a_hull_without_fins_coasts_by_its_damping() -> None:
    craft = Craft(damping_quadratic=(0.0,) * 6, fin_normal=1e-9)
    hull = Hull(craft)
    hull.velocity = 0.2, 0.0, 0.0
    for _ in range(500):
        hull.advance(PERIOD, [0.0] * 4, [0.0] * 4, STILL)
    assert hull.velocity[0] == pytest.approx(0.2 * exp(-10 * 0.6 / craft.total_mass[0]), rel=0.01)


def test_a_long_step_only_slows_a_hull() -> None:
    hull = Hull(Craft())
    hull.velocity = 0.5, 0.0, 0.0
    hull.advance(60.0, [0.0] * 4, [0.0] * 4, STILL)
    assert 0.0 < hull.velocity[0] < 0.5


def test_the_way_follows_the_heading_and_its_deviation_grows() -> None:
    rig = ReckoningRig()
    rig.swim(20)
    ahead = rig.tracks[-1]
    assert ahead.x > 1.0
    assert abs(ahead.y) < 0.01
    rig.swim(20, attitude=EAST)
    assert rig.tracks[-1].y > 1.0
    # The speed's error lies along the way, that of the heading across it.
    assert ahead.deviation_x > ahead.deviation_y > 0.0
    across = [track.deviation_y for track in rig.tracks]
    assert across == sorted(across)


def test_each_arming_begins_a_new_way_and_disarmed_there_is_none() -> None:
    rig = ReckoningRig()
    rig.swim(10)
    count = len(rig.tracks)
    # Also where it is armed again before the next tick.
    rig.reckoning.change_mode("disarmed")
    rig.reckoning.change_mode("automatic")
    rig.swim(0.1)
    assert rig.tracks[-1].x < 0.1 < rig.tracks[count - 1].x
    assert rig.tracks[-1].deviation_x < 0.01
    count = len(rig.tracks)
    rig.reckoning.change_mode("failsafe")
    rig.swim(1, mode="failsafe")
    assert len(rig.tracks) == count


def test_by_hand_the_way_goes_on() -> None:
    rig = ReckoningRig()
    rig.swim(10)
    before = rig.tracks[-1].x
    rig.reckoning.change_mode("manual")
    rig.swim(5, mode="manual")
    assert rig.tracks[-1].x > before + 0.3


def test_in_a_gap_between_the_readings_it_coasts() -> None:
    rig = ReckoningRig()
    rig.swim(10, swing=0.8, period=GAP * 2)
    assert rig.tracks[-1].x == pytest.approx(0.0, abs=1e-6)


def test_without_an_attitude_there_is_no_way() -> None:
    rig = ReckoningRig()
    angles = (0.5, 0.0, 0.0, 0.5)
    motor = Motor(time=0, wanted=angles, angle=angles, drive=(0, 0, 0, 0))
    rig.bus.publish_row(MOTOR, 0.0, motor.to_bytes())
    rig.reckoning.tick("automatic")
    assert (rig.tracks[-1].x, rig.tracks[-1].y) == (0.0, 0.0)
