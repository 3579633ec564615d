"""The set-up of the running robot and its water for a scenario, and the restoring of the previous state."""

import asyncio
import json
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from robot_runtime.contract.commands import (
    CardCommand,
    ControllerCommand,
    LoopCommand,
    RobotCommand,
    SetPointsCommand,
    SteeringCommand,
    StopCommand,
    VisionCommand,
)
from robot_runtime.contract.limits import SET_POINTS, LoopName
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.controllers.base import Controller
from robot_runtime.durable_files import write_whole
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.scenario.events import CommandEvent, LineFaultChange, TimedEvent, WaterEvent
from robot_runtime.simulation.boards.emulator_process import BoardError, EmulatorClient
from robot_runtime.simulation.water.surroundings import Trim
from server.driving.changes import Send
from server.stream.bridge import Bridge, RuntimeSilentError

log = logging.getLogger(__name__)

Request = Mapping[str, Any]
RESTORE_SECONDS = 20.0
"""Time from the first step of a restoration in which a step without an answer is tried again: a process that
has just started may miss the first request, and a killed one is back by then."""
RETRY_SECONDS = 0.2
"""Pause before the next attempt."""
STILL_WATER = {"amplitude": 0.0, "period": 2.0, "direction": 0.0}
ATTITUDE_LOOPS: tuple[LoopName, ...] = tuple(loop for loop in SET_POINTS if loop != "depth")
DIRECTIONS = ("to_board", "from_board")


@dataclass(frozen=True, slots=True)
class SavedState:
    """The runtime's `state`, the water's `surroundings` and the scene's `contents` before a scenario.

    `sight` is None if no scene is rendered.
    """

    robot: Request
    water: Request
    sight: Request | None

    def write(self, path: Path) -> None:
        """Write the state to the disk, durably. Raise OSError."""
        write_whole(path, json.dumps(asdict(self)).encode())

    @classmethod
    def read(cls, path: Path) -> "SavedState | None":
        """Return the state stored by a killed server; None if there is none or it is not readable."""
        try:
            return cls(**json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None


class LiveSetup:
    """Set-up of a scenario at the runtime, the simulator and the board.

    `board_socket` is None for a real board. Every method may raise RefusedError or RuntimeSilentError.
    `patience` is the time in s in which `disarm` and `put_back` try a step without an answer again.
    """

    def __init__(self, bridge: Bridge, board_socket: Path | None, patience: float = RESTORE_SECONDS) -> None:
        self._bridge = bridge
        self._board_socket = board_socket
        self._patience = patience

    async def read(self, robot: Request) -> SavedState:
        """Return the present state; `robot` is the newest `state`."""
        water = await self._bridge.ask_simulator("surroundings", {})
        try:
            return SavedState(robot, water, await self._bridge.scene("contents", {}))
        except RuntimeSilentError:
            return SavedState(robot, water, None)

    async def prepare(self, scenario: Scenario, before: SavedState, send: Send) -> None:
        """Set the scenario's water, the hull at its start, the robot's controller and vision."""
        await self._set_water(_water_of(scenario), before.water)
        start = {name: value for name, value in asdict(scenario.start).items() if value is not None}
        await self._bridge.ask_simulator("reset", {**start, "seed": scenario.seed})
        if before.sight is not None:
            await self._set_sight(_sight_of(scenario))
        await self._clean_line(scenario.seed)
        for name, gains in _gains_of(scenario).items():
            await send(ControllerCommand(name=name, gains=gains))
        control, vision = scenario.control, scenario.vision
        await send(ControllerCommand(name=control.controller))
        await send(SetPointsCommand(default=control.set_point, detected=control.set_point_detected))
        for loop in ATTITUDE_LOOPS:
            await send(_at_rest(loop))
        await send(SteeringCommand(by=control.steering))
        await send(VisionCommand(rate=vision.rate, colour=vision.colour))
        if vision.camera == "card":
            await send(CardCommand())

    async def apply(self, event: TimedEvent, send: Send) -> None:
        """Perform an event at runtime, simulator or board; a bookmark needs none of them."""
        if isinstance(event, LineFaultChange):
            await self._order(event.command)
        elif isinstance(event, WaterEvent):
            await self._bridge.ask_simulator(event.do, event.question)
        elif isinstance(event, CommandEvent):
            await (self._bridge.disarm() if isinstance(event.command, StopCommand) else send(event.command))

    async def disarm(self) -> None:
        """Stop the fins."""
        await _insist(self._bridge.disarm, self._deadline())

    async def put_back(self, before: SavedState, send: Send | None) -> list[str]:
        """Restore the previous state, without `send` all but the robot's; return the problems as text."""
        robot = before.robot
        steps: list[Callable[[], Awaitable[None]]] = [
            lambda: self._clean_line(0),
            lambda: self._set_water(before.water, None),
            lambda: self._set_sight(before.sight),
        ]
        if send is not None:
            steps += [partial(send, command) for command in _commands_of(robot)]
            steps.append(partial(_put_card_back, robot["card"], send))
        problems = []
        end = self._deadline()
        for step in steps:
            try:
                await _insist(step, end)
            except (RefusedError, RuntimeSilentError) as problem:
                problems.append(str(problem))
        return list(dict.fromkeys(problems))

    def _deadline(self) -> float:
        return asyncio.get_running_loop().time() + self._patience

    async def _set_water(self, target: Request, present: Request | None) -> None:
        ask = self._bridge.ask_simulator
        for fault in target["faults"] if present is None else present["faults"]:
            await ask("fault", fault if present is None else {"sensor": fault["sensor"], "kind": "none"})
        # The old waves may be too high for the new basin.
        await ask("waves", STILL_WATER)
        await ask("world", target["world"])
        for name in ("beacons", "current", "waves", "trim"):
            await ask(name, target[name])
        await ask("reset", {})

    async def _set_sight(self, target: Request | None) -> None:
        if target is not None:
            for name in ("world", "targets"):
                await self._bridge.scene(name, target[name])

    async def _clean_line(self, seed: int) -> None:
        if self._board_socket is None:
            return
        for direction in DIRECTIONS:
            await self._order(f"line {direction} clean")
            await self._order(f"line {direction} stall 0")
        await self._order(f"seed {seed}")

    async def _order(self, command: str) -> None:
        assert self._board_socket is not None
        try:
            await asyncio.to_thread(_order, self._board_socket, command)
        except BoardError as problem:
            raise RefusedError(f"The emulated board: {problem}.") from problem


async def _insist(step: Callable[[], Awaitable[object]], end: float) -> None:
    """Take a step, repeated without an answer until `end` (loop time). Raise RuntimeSilentError then."""
    loop = asyncio.get_running_loop()
    while True:
        try:
            await step()
            return
        except RuntimeSilentError as problem:
            if loop.time() + RETRY_SECONDS > end:
                raise
            log.info("Restoring the state before the scenario, next attempt: %s", problem)
        await asyncio.sleep(RETRY_SECONDS)


def _order(socket: Path, command: str) -> None:
    with EmulatorClient(socket) as board:
        board.command(command)


def _water_of(scenario: Scenario) -> Request:
    """Return the scenario's water as requests to the simulator."""
    basin, robot = scenario.scene.basin, scenario.robot
    trim = scenario.trim or Trim.of(robot)
    return {
        "world": {name: value for name, value in asdict(basin).items() if value is not None},
        "current": asdict(scenario.water.current),
        "waves": asdict(scenario.water.waves),
        "trim": asdict(trim),
        "beacons": {"positions": [list(beacon) for beacon in scenario.scene.beacons]},
        "faults": [],
    }


def _sight_of(scenario: Scenario) -> Request:
    """Return the scenario's scene as requests to the simulator."""
    scene = scenario.scene
    return {
        "world": {"kind": scene.kind, "turbidity": scene.turbidity},
        "targets": {
            "targets": [asdict(target) | {"position": list(target.position)} for target in scene.targets]
        },
    }


def _gains_of(scenario: Scenario) -> dict[str, dict[str, float]]:
    """Return every gain of every depth controller, the default unless the scenario sets it."""
    return {
        controller.name: _defaults(controller) | scenario.control.gains.get(controller.name, {})
        for controller in CONTROLLERS["depth"]
    }


def _at_rest(loop: LoopName) -> LoopCommand:
    """Return the command that sets a loop to its state at the runtime's start."""
    first = CONTROLLERS[loop][0]
    return LoopCommand(name=loop, on=False, set_point=0.0, controller=first.name, gains=_defaults(first))


def _commands_of(robot: Request) -> list[RobotCommand]:
    """Return the commands that set control and vision to this state of the robot."""
    depth = next(loop for loop in robot["loops"] if loop["name"] == "depth")
    return [
        *(
            ControllerCommand(name=controller["name"], gains=_values(controller["gains"]))
            for controller in depth["controllers"]
        ),
        ControllerCommand(name=depth["controller"]),
        SetPointsCommand(default=robot["set_point_default"], detected=robot["set_point_detected"]),
        *_loops_of(robot),
        SteeringCommand(by=robot["steering"]),
        VisionCommand(rate=robot["vision_rate"], colour=robot["vision_colour"]),
    ]


def _loops_of(robot: Request) -> list[LoopCommand]:
    """Return the commands that restore heading, pitch and roll."""
    commands: list[LoopCommand] = []
    for loop in robot["loops"]:
        if loop["name"] not in ATTITUDE_LOOPS:
            continue
        name = loop["name"]
        commands += [
            LoopCommand(name=name, controller=controller["name"], gains=_values(controller["gains"]))
            for controller in loop["controllers"]
        ]
        commands.append(
            LoopCommand(name=name, controller=loop["controller"], on=loop["on"], set_point=loop["set_point"])
        )
    return commands


async def _put_card_back(colour: str | None, send: Send) -> None:
    try:
        await send(CardCommand(colour=colour))
    except RefusedError:
        # A camera without cards had none before.
        if colour is not None:
            raise


def _values(gains: Sequence[Request]) -> dict[str, float]:
    return {gain["name"]: gain["value"] for gain in gains}


def _defaults(controller: type[Controller]) -> dict[str, float]:
    return {name: limits.default for name, limits in controller.limits.items()}
