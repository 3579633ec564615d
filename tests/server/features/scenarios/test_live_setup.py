"""A scenario's set-up of water, line and robot, and its undoing."""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import pytest

from robot_runtime.contract.commands import RobotCommand
from robot_runtime.control.controllers.pid import HeadingPid
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.firmware import firmware_path
from robot_runtime.simulation.water.faults import SimulatedFault
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import Simulator
from server.features.scenarios.live_setup import LiveSetup
from server.stream.bridge import Bridge, RuntimeSilentError
from tests.server.features.scenarios.direct_bridge import SCENARIO, STATE, DirectBridge
from tests.stack import ROOT


@pytest.fixture
def simulator() -> Simulator:
    return Simulator(SimulationParameters(), seed=1)


@pytest.fixture
def bridge(simulator: Simulator) -> DirectBridge:
    return DirectBridge(simulator)


@pytest.fixture
def board() -> Iterator[EmulatorProcess]:
    build = ROOT / "build"
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        tty, socket = Path(name) / "tty", Path(name) / "socket"
        with EmulatorProcess(
            build / "board", firmware_path(build, 250_000, ".elf"), tty, socket, "--paused"
        ) as visitor:
            yield visitor


@pytest.fixture
def surroundings(bridge: DirectBridge, board: EmulatorProcess) -> LiveSetup:
    return LiveSetup(cast(Bridge, bridge), board.socket)


async def test_everything_is_set_up(
    surroundings: LiveSetup, simulator: Simulator, bridge: DirectBridge
) -> None:
    simulator.set_fault("battery", SimulatedFault(kind="drift", speed=0.1))
    await surroundings.prepare(SCENARIO, await surroundings.read(STATE), bridge.send)
    now = simulator.surroundings()
    assert (now.basin, now.current, now.waves) == (
        SCENARIO.scene.basin,
        SCENARIO.water.current,
        SCENARIO.water.waves,
    )
    assert (now.trim, now.beacons) == (SCENARIO.trim, ((1.0, 0.0, 0.5),))
    assert {fault.kind for fault in now.faults.values()} == {"none"}
    assert simulator.truth().position == pytest.approx((1.0, 0.0, 0.7))
    gains = [question["gains"] for _, question in bridge.commands if question.get("name") == "pid"]
    assert gains == [{"kp": 4.0, "ki": 0.4, "kd": 2.0}]
    loops = {question["name"]: question for name, question in bridge.commands if name == "loop"}
    assert [(loop["on"], loop["set_point"]) for loop in loops.values()] == [(False, 0.0)] * 3
    assert loops["heading"]["gains"] == HeadingPid().gains
    assert bridge.commands[-1] == ("card", {})
    assert bridge.sight["world"] == {"kind": "pool", "turbidity": 0.1}
    target = {"colour": "green", "position": [2.0, 0.0, 1.0], "size": 0.2}
    assert bridge.sight["targets"] == {"targets": [target]}


async def test_everything_is_undone(
    surroundings: LiveSetup, simulator: Simulator, bridge: DirectBridge, board: EmulatorProcess
) -> None:
    simulator.set_fault("battery", SimulatedFault(kind="drift", speed=0.1))
    was, seen = simulator.surroundings(), dict(bridge.sight)
    before = await surroundings.read(STATE)
    await surroundings.prepare(SCENARIO, before, bridge.send)
    for event in SCENARIO.events:
        await surroundings.apply(event, bridge.send)
    bridge.commands.clear()
    problems = await surroundings.put_back(before, bridge.send)
    assert problems == []
    assert bridge.sight == seen
    assert simulator.surroundings() == was
    assert bridge.commands == [
        ("controller", {"name": "pid", "gains": {"kp": 7.0}}),
        ("controller", {"name": "bang_bang"}),
        ("set_points", {"default": 0.9, "detected": 1.1}),
        ("loop", {"name": "heading", "controller": "pid", "gains": {"kp": 2.0}}),
        ("loop", {"name": "heading", "controller": "bang_bang_dead_zone"}),
        ("loop", {"name": "heading", "controller": "pid", "on": True, "set_point": 0.4}),
        ("steering", {"by": "beacons"}),
        ("vision", {"rate": 4.0, "colour": "yellow"}),
        ("card", {"colour": "red"}),
    ]
    with board.connect() as line:
        before_run = line.stats()["to_board_cuts"]
        line.run(1.0)
        assert line.stats()["to_board_cuts"] == before_run


async def test_a_failed_step_of_the_undoing_is_reported_and_the_rest_is_done(
    simulator: Simulator, bridge: DirectBridge
) -> None:
    was = simulator.surroundings()
    surroundings = LiveSetup(cast(Bridge, bridge), Path("/nowhere/socket"))
    before = await surroundings.read(STATE)
    with pytest.raises(RefusedError, match="The emulated board: no emulated board answers"):
        await surroundings.prepare(SCENARIO, before, bridge.send)
    (problem,) = await surroundings.put_back(before, bridge.send)
    assert "no emulated board answers" in problem
    assert simulator.surroundings() == was
    assert bridge.commands[-1] == ("card", {"colour": "red"})


async def test_a_step_without_an_answer_is_tried_again(simulator: Simulator, bridge: DirectBridge) -> None:
    silences = ["set_points", "card"]

    async def silent_once(command: RobotCommand) -> None:
        if command.policy.name in silences:
            silences.remove(command.policy.name)
            bridge.silent = 1
        await bridge.send(command)

    was = simulator.surroundings()
    surroundings = LiveSetup(cast(Bridge, bridge), None)
    before = await surroundings.read(STATE)
    await surroundings.prepare(SCENARIO, before, bridge.send)
    bridge.commands.clear()
    bridge.silent = 1
    await surroundings.disarm()
    bridge.silent = 1
    problems = await surroundings.put_back(before, silent_once)
    assert not silences
    assert problems == []
    assert simulator.surroundings() == was
    names = [name for name, _ in bridge.commands]
    assert names == [
        "stop",
        "controller",
        "controller",
        "set_points",
        *["loop"] * 3,
        "steering",
        "vision",
        "card",
    ]


async def test_a_runtime_that_stays_silent_is_given_up_and_reported(bridge: DirectBridge) -> None:
    surroundings = LiveSetup(cast(Bridge, bridge), None, patience=0.3)
    before = await surroundings.read(STATE)
    bridge.silent = 10_000
    with pytest.raises(RuntimeSilentError):
        await surroundings.disarm()
    problems = await surroundings.put_back(before, bridge.send)
    assert problems == ["The robot's runtime does not answer."]
    assert 10_000 - bridge.silent < 30
    assert bridge.commands == []
