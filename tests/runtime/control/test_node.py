"""The control node in simulated time: set points from vision, commands only while armed."""

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Control, Detection, Event, Mode
from robot_runtime.contract.packets import Beacon, Countdown, Depth, Navigation
from robot_runtime.contract.topics import BEACON, CONTROL, DEPTH, DETECTION, EVENT
from robot_runtime.control.node import BEACON_STALE, ControlNode
from robot_runtime.control.pilot import Pilot
from robot_runtime.errors import RefusedError
from robot_runtime.transport.bus import Bus


class ControlNodeRig:
    """A control node with its bus, clock and sent commands."""

    def __init__(self) -> None:
        self.clock, self.bus = SimulatedClock(100.0), Bus()
        self.commands: list[Navigation] = []
        self.ticks: list[Control] = []
        self.events: list[str] = []
        self.pilot = Pilot(self.clock)
        self.node = ControlNode(self.bus, self.clock, self._take, self.pilot)
        self.node.change_mode("automatic")
        self.node.colour = "yellow"
        self.bus.on_row(CONTROL, lambda _, record: self.ticks.append(Control.from_bytes(record)))
        self.bus.on_document(EVENT, self._event)

    def _take(self, packet: Navigation | Countdown) -> None:
        assert isinstance(packet, Navigation)
        self.commands.append(packet)

    def _event(self, event: Event) -> None:
        self.events.append(event.text)

    def depth(self, metres: float) -> None:
        record = Depth(time=0, depth=metres, pressure=0, temperature=0.0)
        self.bus.publish_row(DEPTH, self.clock.now(), record.to_bytes())

    def lights(self, right: bool, left: bool) -> None:
        record = Beacon(time=0, right=int(right), left=int(left))
        self.bus.publish_row(BEACON, self.clock.now(), record.to_bytes())

    def see(self, colour: str | None, target: str | None = None, set_point: float | None = None) -> None:
        now = self.clock.now()
        seen = Detection(
            time=now,
            taken=now,
            colour=colour,
            box=None,
            area=0.1,
            processing=0.001,
            target=colour if target is None else target,
            set_point=set_point,
        )
        self.bus.publish_document(DETECTION, seen)

    def tick(self) -> None:
        self.clock.forward(0.1)
        self.node.tick()


@pytest.fixture
def rig() -> ControlNodeRig:
    return ControlNodeRig()


def test_no_command_before_the_first_depth(rig: ControlNodeRig) -> None:
    rig.tick()
    assert rig.commands == []
    assert rig.ticks == []


def test_commands_go_out_only_while_armed(rig: ControlNodeRig) -> None:
    rig.depth(0.2)
    rig.node.change_mode("disarmed")
    rig.tick()
    assert rig.commands == []
    assert (rig.ticks[0].output, rig.ticks[0].error) == (0.0, pytest.approx(0.3))
    rig.node.change_mode("automatic")
    rig.tick()
    assert [command.z for command in rig.commands] == [1.0]
    assert rig.ticks[1].latency == pytest.approx(0.2)


def test_the_target_colour_changes_the_set_point_and_its_loss_restores_it(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.see("yellow")
    rig.tick()
    rig.see(None)
    rig.tick()
    assert [tick.set_point for tick in rig.ticks] == [1.0, 0.5]
    assert rig.events == ["Set point 1.00 m: yellow is seen.", "Set point 0.50 m."]


def test_another_colour_changes_nothing(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.see("red")
    rig.tick()
    assert rig.ticks[0].set_point == 0.5


def test_a_seen_colour_or_marker_with_an_action_sets_its_set_point(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.see("red", "red", 0.8)
    rig.tick()
    rig.see(None, "marker 7", 1.5)
    rig.tick()
    # The target colour's own set point has priority over the general one.
    rig.see("yellow", "yellow", 2.0)
    rig.tick()
    rig.see("red")
    rig.tick()
    assert [tick.set_point for tick in rig.ticks] == pytest.approx([0.8, 1.5, 2.0, 0.5])
    assert rig.events[:2] == ["Set point 0.80 m: red is seen.", "Set point 1.50 m: marker 7 is seen."]


def test_the_age_of_a_picture_is_that_at_its_first_tick(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.tick()
    assert rig.node.picture_age is None
    rig.see(None)
    rig.tick()
    rig.tick()
    assert rig.node.picture_age == pytest.approx(0.1)
    rig.see("yellow")
    rig.clock.forward(0.05)
    rig.tick()
    assert rig.node.picture_age == pytest.approx(0.15)


def test_a_detection_expires_within_a_second(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.see("yellow")
    set_points = []
    for _ in range(12):
        rig.tick()
        set_points.append(rig.ticks[-1].set_point)
    assert set_points == [1.0] * 9 + [0.5] * 3


def test_a_controller_starts_afresh_at_each_arming(rig: ControlNodeRig) -> None:
    rig.node.set_loop("depth", controller="pid", gains={"kp": 0.0, "ki": 1.0, "kd": 0.0})
    rig.depth(0.0)
    modes: tuple[Mode, ...] = (*("automatic",) * 4, "disarmed", "automatic")
    for mode in modes:
        rig.node.change_mode(mode)
        rig.tick()
    outputs = [command.z for command in rig.commands]
    assert outputs[3] > outputs[2] > outputs[1] == 0
    assert outputs[4] == 0


@pytest.mark.parametrize(
    ("name", "gains", "why"),
    [
        ("fuzzy", {}, "no controller 'fuzzy'; there are bang_bang"),
        ("pid", {"kp": float("nan")}, "kp is nan"),
        ("pid", {"kp": 1e9}, "between 0 and 50"),
    ],
)
def test_an_invalid_controller_is_refused_and_the_old_one_stays(
    rig: ControlNodeRig, name: str, gains: dict[str, float], why: str
) -> None:
    before = rig.node.depth.controller
    with pytest.raises(RefusedError, match=why):
        rig.node.set_loop("depth", controller=name, gains=gains)
    assert rig.node.depth.controller is before


@pytest.mark.parametrize("depth", [-0.1, 10.1, float("nan"), float("inf")])
def test_set_points_out_of_range_are_refused(rig: ControlNodeRig, depth: float) -> None:
    for pair in ((depth, 1.0), (0.5, depth)):
        with pytest.raises(RefusedError, match="not between 0 and 10"):
            rig.node.set_points(*pair)
    assert (rig.node.set_point_default, rig.node.set_point_detected) == (0.5, 1.0)


def test_it_steers_to_a_light_only_when_enabled(rig: ControlNodeRig) -> None:
    rig.depth(0.5)
    rig.lights(right=True, left=False)
    rig.tick()
    assert (rig.commands[-1].x, rig.commands[-1].yaw) == (0.0, 0.0)
    rig.node.steer("beacons")
    rig.tick()
    assert rig.commands[-1].x > 0
    assert rig.commands[-1].yaw > 0
    with pytest.raises(RefusedError, match="there is no steering 'home'"):
        rig.node.steer("home")
    assert rig.node.steering == "beacons"


def test_a_light_not_seen_for_too_long_is_searched(rig: ControlNodeRig) -> None:
    rig.node.steer("beacons")
    rig.lights(right=True, left=True)
    rig.clock.forward(BEACON_STALE)
    rig.depth(0.5)
    rig.tick()
    assert rig.commands[-1].x == 0.0
    assert rig.commands[-1].yaw != 0.0
