"""A scenario, a state of the robot, and a bridge to a simulator in the test's own process."""

from collections.abc import Mapping
from typing import Any

from robot_runtime.contract.commands import RobotCommand
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.simulation.water.requests import changes
from robot_runtime.simulation.water.simulator import Simulator
from server.stream.bridge import RuntimeSilentError

STATE: dict[str, Any] = {
    "set_point_default": 0.9,
    "set_point_detected": 1.1,
    "steering": "beacons",
    "loops": [
        {
            "name": "depth",
            "on": False,
            "set_point": 0.9,
            "controller": "bang_bang",
            "controllers": [{"name": "pid", "gains": [{"name": "kp", "value": 7.0}]}],
        },
        {
            "name": "heading",
            "on": True,
            "set_point": 0.4,
            "controller": "pid",
            "controllers": [
                {"name": "pid", "gains": [{"name": "kp", "value": 2.0}]},
                {"name": "bang_bang_dead_zone", "gains": []},
            ],
        },
    ],
    "vision_rate": 4.0,
    "vision_colour": "yellow",
    "card": "red",
}

SCENARIO = read_scenario("""
name = "all"
title = "All of the water"
duration = 9
seed = 5
[scene]
kind = "pool"
depth = 2
length = 4
width = 3
beacons = [[1, 0, 0.5]]
targets = [{ colour = "green", position = [2, 0, 1] }]
[start]
north = 1
down = 0.7
[water]
current = { north = 0.1 }
waves = { amplitude = 0.05 }
[trim]
buoyancy = 1.01
forward = 0
right = 0
above = 0.02
[control]
gains.pid.kp = 4
[[events]]
at = 1
do = "fault"
sensor = "pressure"
kind = "stuck"
[[events]]
at = 2
do = "line"
direction = "to_board"
kind = "cut"
on = true
[[events]]
at = 3
do = "card"
colour = "red"
""")


class DirectBridge:
    """Passes requests to a simulator in this process, and records commands to the runtime."""

    def __init__(self, simulator: Simulator) -> None:
        self.commands: list[tuple[str, Mapping[str, Any]]] = []
        self.reserved_reason: str | None = None
        self.sight: dict[str, Any] = {"world": {"turbidity": 0.2}, "targets": {"targets": []}}
        self.silent = 0
        """Requests that get no answer from now on."""
        self._changes = changes(simulator)

    async def send(self, command: RobotCommand) -> None:
        self._answer()
        self.commands.append((command.policy.name, command.payload()))

    async def disarm(self) -> None:
        self._answer()
        self.commands.append(("stop", {}))

    async def scene(self, name: str, payload: Mapping[str, Any]) -> Mapping[str, Any]:
        if name == "contents":
            return dict(self.sight)
        self.sight[name] = payload
        return {}

    async def ask_simulator(self, name: str, payload: Mapping[str, Any]) -> Mapping[str, Any]:
        self._answer()
        return self._changes[name](payload) or {}

    def _answer(self) -> None:
        """Raise RuntimeSilentError if this request gets no answer."""
        if self.silent:
            self.silent -= 1
            raise RuntimeSilentError("The robot's runtime does not answer.", waited=True)
