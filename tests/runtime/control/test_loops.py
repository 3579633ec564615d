"""The control loops: steering, holds in manual, and refusals."""

import json
from math import isnan, pi

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Mode, Turning
from robot_runtime.contract.packets import Countdown, Depth, Imu, Navigation
from robot_runtime.contract.topics import DEPTH, IMU, TURNING
from robot_runtime.control.attitude import GRAVITY
from robot_runtime.control.controllers.bang_bang import BangBang
from robot_runtime.control.loop import LoopOverride
from robot_runtime.control.node import ControlNode, Course
from robot_runtime.control.pilot import Pilot
from robot_runtime.errors import RefusedError
from robot_runtime.transport.bus import Bus
from tests.runtime.control.attitudes import quaternion


class ControlLoopRig:
    """A control node with a pilot, and its sent commands."""

    def __init__(self, mode: Mode) -> None:
        self.clock, self.bus = SimulatedClock(100.0), Bus()
        self.commands: list[Navigation] = []
        self.countdowns: list[float] = []
        self.turning: list[Turning] = []
        self.pilot = Pilot(self.clock)
        self.node = ControlNode(self.bus, self.clock, self._take, self.pilot)
        self.bus.on_row(TURNING, lambda _, record: self.turning.append(Turning.from_bytes(record)))
        self.node.change_mode(mode)
        self._sequence = 0
        self._sticks: dict[str, float] = {}
        self.depth(0.6)
        self.attitude(heading=1.0)

    def _take(self, packet: Navigation | Countdown) -> None:
        if isinstance(packet, Countdown):
            self.countdowns.append(packet.remaining)
        else:
            self.commands.append(packet)

    def depth(self, metres: float) -> None:
        record = Depth(time=0, depth=metres, pressure=0, temperature=0.0)
        self.bus.publish_row(DEPTH, self.clock.now(), record.to_bytes())

    def attitude(self, heading: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> None:
        rest = (0.0, 0.0, 0.0)
        record = Imu(time=0, attitude=quaternion(heading, pitch, roll), rate=rest, force=rest)
        self.bus.publish_row(IMU, self.clock.now(), record.to_bytes())

    def feel(self, *force: float) -> None:
        """A specific force, m/s², in body axes, of a hull that lies on its right side."""
        x, y, z = force
        record = Imu(time=0, attitude=quaternion(2.0, 0.0, pi / 2), rate=(0.0, 0.0, 0.0), force=(x, y, z))
        self.bus.publish_row(IMU, self.clock.now(), record.to_bytes())

    def push(self, **axes: float) -> None:
        """Move the sticks to this position."""
        self._sequence += 1
        sticks = [axes.get(name, 0.0) for name in ("x", "y", "z", "roll", "pitch", "yaw")]
        text = {"lease": 0, "sequence": self._sequence, "taken": self.clock.now(), "axes": sticks}
        assert self.pilot.take(json.dumps(text).encode())

    def tick(self) -> Navigation | None:
        """Run one tick; return its command."""
        self.clock.forward(0.1)
        self.push(**self._sticks)
        before = len(self.commands)
        self.node.tick()
        return self.commands[-1] if len(self.commands) > before else None

    def hold(self, **sticks: float) -> None:
        """Hold the sticks in this position from now on."""
        self._sticks = sticks


def test_angle_loops_run_only_when_enabled() -> None:
    rig = ControlLoopRig("automatic")
    command = rig.tick()
    assert command is not None
    assert (command.yaw, command.pitch, command.roll) == (0.0, 0.0, 0.0)
    assert all(isnan(number) for number in (*rig.turning[-1].set_point, *rig.turning[-1].output))
    assert rig.turning[-1].measured == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)
    rig.node.set_loop("heading", on=True, set_point=1.5)
    command = rig.tick()
    assert command is not None
    assert command.yaw > 0
    assert (command.pitch, command.roll) == (0.0, 0.0)
    assert rig.turning[-1].set_point[0] == pytest.approx(1.5)
    assert rig.turning[-1].output[0] == pytest.approx(command.yaw, abs=0.01)


@pytest.mark.parametrize(
    ("goal", "measured", "side"), [(3.0, -3.0, -1), (-3.0, 3.0, 1), (0.1, -0.1, 1), (-pi, 3.0, 1)]
)
def test_a_heading_is_reached_the_short_way_round(goal: float, measured: float, side: int) -> None:
    rig = ControlLoopRig("automatic")
    rig.attitude(heading=measured)
    rig.node.set_loop("heading", on=True, set_point=goal)
    command = rig.tick()
    assert command is not None
    assert command.yaw * side > 0


def test_a_countdown_is_sent_until_its_course_expires() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.override_course(Course(rig.clock.now() + 0.25, still=True, countdown=4.0))
    for _ in range(4):
        command = rig.tick()
        assert command is not None
        assert command.z == 0.0
    assert rig.countdowns == [4.0, 4.0]
    rig.node.override_course(Course(rig.clock.now() + 0.25, still=True, countdown=4.0))
    rig.node.change_mode("disarmed")
    rig.tick()
    assert rig.countdowns == [4.0, 4.0]


def test_a_course_outranks_a_heading_hold_that_is_on() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("heading", on=True, set_point=1.5)
    rig.node.override_course(Course(rig.clock.now() + 10.0, x=0.3, yaw=-0.5))
    command = rig.tick()
    assert command is not None
    assert (command.x, command.yaw) == pytest.approx((0.3, -0.5), abs=0.01)
    rig.node.override_course(Course(rig.clock.now()))
    command = rig.tick()
    assert command is not None
    assert (command.x, command.yaw) == (0.0, 0.0)
    rig.node.heading.override = LoopOverride(set_point=0.5)
    command = rig.tick()
    assert command is not None
    assert command.yaw < 0
    rig.node.heading.override = None
    rig.node.override_course(None)
    command = rig.tick()
    assert command is not None
    assert command.yaw > 0


def test_passing_south_is_no_jump_for_the_controllers_speed() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("heading", on=True, set_point=pi, gains={"kp": 0.0, "ki": 0.0, "kd": 1.0})
    outputs = []
    for heading in (3.0, 3.1, -3.083, -2.983):
        rig.attitude(heading=heading)
        command = rig.tick()
        assert command is not None
        outputs.append(command.yaw)
    assert all(-0.9 < output < 0 for output in outputs[1:])


def test_pitch_and_roll_push_against_their_error() -> None:
    rig = ControlLoopRig("automatic")
    rig.attitude(pitch=0.2, roll=-0.2)
    for name in ("pitch", "roll"):
        rig.node.set_loop(name, on=True)
    for _ in range(3):
        command = rig.tick()
    assert command is not None
    assert command.pitch < 0 < command.roll


def test_the_depth_loop_gets_the_mean_heave_acceleration() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("depth", controller="predictive")
    rig.tick()
    # The right of the hull is down.
    rig.feel(1.0, 0.3 - GRAVITY, 2.0)
    rig.feel(3.0, 0.1 - GRAVITY, -1.0)
    rig.tick()
    assert rig.node.depth.heave_acceleration == pytest.approx(0.2, abs=0.002)
    rig.tick()
    assert rig.node.depth.heave_acceleration is None


def test_steering_to_a_light_has_yaw_alone() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("heading", on=True, set_point=-2.0)
    rig.node.steer("beacons")
    command = rig.tick()
    assert command is not None
    assert command.yaw == pytest.approx(0.5, abs=0.01)
    assert isnan(rig.turning[-1].output[0])


def test_all_holds_are_off_at_the_start_and_the_end_of_manual() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("heading", on=True)
    modes: tuple[Mode, ...] = ("manual", "automatic", "manual", "disarmed", "manual")
    for mode in modes:
        rig.node.change_mode(mode)
        assert not any(loop.on for loop in rig.node.loops.values())
        if mode == "manual":
            rig.tick()
            for name in rig.node.loops:
                rig.node.set_loop(name, on=True)


def test_in_manual_nothing_is_held_by_default() -> None:
    rig = ControlLoopRig("manual")
    rig.hold(z=0.0, x=0.5)
    command = rig.tick()
    assert command == Navigation(x=0.5, y=0.0, z=0.0, roll=0.0, pitch=0.0, yaw=0.0)


@pytest.mark.parametrize("name", ["depth", "heading"])
def test_a_hold_takes_the_value_at_its_start_or_at_the_release_of_the_stick(name: str) -> None:
    axis = {"depth": "z", "heading": "yaw"}[name]
    rig = ControlLoopRig("manual")
    loop = rig.node.loops[name]

    def be(value: float) -> Navigation:
        rig.depth(value) if name == "depth" else rig.attitude(heading=value)
        command = rig.tick()
        assert command is not None
        return command

    be(0.6)
    rig.node.set_loop(name, on=True)
    assert loop.set_point == pytest.approx(0.6, abs=1e-3)
    assert getattr(be(0.5), axis) > 0
    rig.hold(**{axis: -0.7, "x": 1.0})
    for value in (0.45, 0.3, 0.2):
        command = be(value)
        assert (getattr(command, axis), command.x) == (-0.7, 1.0)
    assert loop.set_point == pytest.approx(0.2, abs=1e-3)
    rig.hold(x=1.0)
    assert getattr(be(0.1), axis) > 0
    assert loop.set_point == pytest.approx(0.2, abs=1e-3)
    rig.node.set_loop(name, on=False)
    assert getattr(be(0.1), axis) == 0.0


def test_a_hold_gives_no_command_while_the_fins_rest_for_a_silent_pilot() -> None:
    rig = ControlLoopRig("manual")
    rig.tick()
    rig.node.set_loop("depth", on=True, set_point=2.0)
    command = rig.tick()
    assert command is not None
    assert command.z > 0
    rig.clock.forward(0.5)
    rig.node.tick()
    assert rig.commands[-1].z == 0.0


def test_pilot_input_is_sent_at_once_with_the_commands_of_the_holds() -> None:
    rig = ControlLoopRig("manual")
    rig.tick()
    rig.node.set_loop("depth", on=True, set_point=2.0)
    rig.tick()
    rig.push(x=-1.0)
    rig.node.drive()
    assert rig.commands[-1].x == -1.0
    assert rig.commands[-1].z > 0
    rig.node.change_mode("disarmed")
    before = len(rig.commands)
    rig.node.drive()
    assert len(rig.commands) == before


def test_an_override_steers_until_the_mode_changes() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.heading.override = LoopOverride(BangBang(), set_point=-1.0)
    command = rig.tick()
    assert command is not None
    assert command.yaw == -1.0
    assert rig.turning[-1].set_point[0] == -1.0
    rig.node.change_mode("disarmed")
    rig.node.change_mode("automatic")
    command = rig.tick()
    assert command is not None
    assert command.yaw == 0.0


def test_the_depth_set_point_is_the_default_except_for_a_hold_in_manual() -> None:
    rig = ControlLoopRig("automatic")
    rig.node.set_loop("depth", set_point=0.8)
    rig.tick()
    assert (rig.node.set_point_default, rig.node.depth.set_point) == (0.8, 0.8)
    rig.node.change_mode("manual")
    rig.tick()
    rig.node.set_loop("depth", on=True, set_point=1.2)
    rig.tick()
    assert (rig.node.set_point_default, rig.node.depth.set_point) == (0.8, 1.2)


@pytest.mark.parametrize(
    ("name", "change", "why"),
    [
        ("yaw", {}, "no loop 'yaw'; there are depth, heading, pitch, roll"),
        ("heading", {"set_point": 3.2}, "183 is not between -180 and 180 °"),
        ("heading", {"set_point": float("nan")}, "not between"),
        ("pitch", {"set_point": -0.6}, "-34 is not between"),
        ("depth", {"set_point": 10.1}, "10.1 is not between 0 and 10 m"),
        ("depth", {"on": True}, "Automatic always holds the depth"),
        ("heading", {"controller": "bang_bang"}, "no controller 'bang_bang'; there are pid"),
        ("heading", {"gains": {"kp": 1e9}}, "kp is 1000000000.0"),
        ("heading", {"on": True, "set_point": 1.0, "gains": {"kq": 1.0}}, "no gain 'kq'"),
    ],
)
def test_invalid_settings_are_refused_and_change_nothing(
    name: str, change: dict[str, object], why: str
) -> None:
    rig = ControlLoopRig("automatic")
    before = [(loop.on, loop.set_point, loop.controller) for loop in rig.node.loops.values()]
    with pytest.raises(RefusedError, match=why):
        rig.node.set_loop(name, **change)  # type: ignore[arg-type]
    assert [(loop.on, loop.set_point, loop.controller) for loop in rig.node.loops.values()] == before


def test_a_value_that_is_not_measured_cannot_be_held() -> None:
    rig = ControlLoopRig("manual")
    with pytest.raises(RefusedError, match="The heading is not measured yet"):
        rig.node.set_loop("heading", on=True)
