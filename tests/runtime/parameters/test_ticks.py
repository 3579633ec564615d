"""The whole robot without its threads: a control tick sees all of a change or none of it."""

import threading
from functools import partial
from typing import Any

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.commands import Commands
from robot_runtime.config import Config
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import DEPTH
from robot_runtime.control.controllers.pid import Pid
from robot_runtime.core import Core
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import Outbox
from robot_runtime.vision.node import VisionNode

TICK_SECONDS = 0.1
"""Real s for which a change has the chance to come into the middle of a tick."""

CHANGES: dict[str, dict[str, Any]] = {
    "parameters": {"values": {"depth.pid.kp": 9, "depth.pid.ki": 9, "depth.pid.kd": 9}},
    "controller": {"name": "pid", "gains": {"kp": 9, "ki": 9, "kd": 9}},
}


class Swimmer(Core):
    """A robot that steers at a depth of 1 m, despite any fault."""

    def __init__(self) -> None:
        clock = SimulatedClock()
        line = LinkDriver("none", 250_000, clock, 1, lambda _: None, lambda: None)
        outbox = Outbox(lambda *_: None, lambda _: False)
        config = Config()
        open_vision = partial(VisionNode, config.vision, clock)
        super().__init__(
            config, clock, "0" * 16, line, outbox, watched=lambda _: False, open_vision=open_vision
        )
        self.control.set_loop("depth", controller="pid", gains={"kp": 1, "ki": 1, "kd": 1})
        self.supervisor.mode = "automatic"
        self.control.change_mode("automatic")
        depth = Depth(time=0, depth=1.0, pressure=111_000, temperature=20.0)
        self.bus.publish_row(DEPTH, clock.now(), depth.to_bytes())

    def check_faults(self) -> None:
        """Report no fault."""


@pytest.mark.parametrize("name", CHANGES)
def test_a_tick_sees_all_of_a_change_or_none(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Swimmer()
    command = Commands(robot).do[name]
    changed = threading.Event()

    def change() -> None:
        command(CHANGES[name])
        changed.set()

    thread = threading.Thread(target=change)
    seen: list[dict[str, float]] = []
    came_between: list[bool] = []

    def step(self: Pid, *_: Any) -> float:
        seen.append(dict(self.gains))
        if not thread.ident:
            thread.start()
            came_between.append(changed.wait(TICK_SECONDS))
            seen.append(dict(self.gains))
        return 0.0

    monkeypatch.setattr(Pid, "step", step)
    robot.control_tick()
    thread.join()
    robot.control_tick()
    old, new = (dict.fromkeys(("kp", "ki", "kd"), value) for value in (1.0, 9.0))
    assert seen == [old, old, new]
    assert came_between == [False]


def test_other_commands_change_parameters_and_report_the_changes() -> None:
    robot = Swimmer()
    do = Commands(robot).do
    assert do["set_points"]({"default": 2.0}) == {"changed": {"control.set_point": [0.5, 2.0]}}
    assert do["vision"]({"rate": 10.0, "colour": "red"}) == {
        "changed": {"vision.rate": [4.0, 10.0], "vision.colour": ["yellow", "red"]}
    }
    assert do["steering"]({"by": "beacons"}) == {"changed": {"control.steering": ["none", "beacons"]}}
    values = robot.parameters.values()
    assert (values["control.set_point"], values["vision.rate"], values["control.steering"]) == (
        2.0,
        10.0,
        "beacons",
    )


def test_every_parameter_accepts_its_default_and_has_a_meaning() -> None:
    robot = Swimmer()
    robot.supervisor.mode = "disarmed"
    for parameter in robot.parameters.listed():
        assert parameter.meaning
        robot.parameters.apply({parameter.name: parameter.default})
        if parameter.type == "number":
            assert parameter.minimum is not None
            assert parameter.maximum is not None
            robot.parameters.apply({parameter.name: parameter.minimum})
            robot.parameters.apply({parameter.name: parameter.maximum})
