"""The water of a board in the loop, with the real Zenoh and fins that the test moves."""

import json
import tempfile
import threading
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from math import sin

import pytest

from robot_runtime.contract.packets import Motor, Sense
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.water import hil
from robot_runtime.simulation.water.hil import GAP_MAX, HilSimulator
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.transport.blocks import Block, read_blocks, read_rows, row
from robot_runtime.transport.zenoh_transport import ZenohTransport, join
from tests.waiting import SECONDS, wait_for

PERIOD = 0.02


class FinSender:
    """The runtime's end: sends fins, receives readings."""

    def __init__(self, messages: ZenohTransport) -> None:
        self.water: ZenohTransport
        self.senses: list[Sense] = []
        self._messages = messages
        self._number = 0
        messages.subscribe("sense", lambda _, data: self.senses.append(Sense.from_bytes(data)))

    def subscribe(self, topic: str, hear: Callable[[str, bytes], None]) -> None:
        """Have everything heard that the water sends of a topic; return once the water knows it."""
        self._messages.subscribe(topic, hear)
        wait_for(lambda: self.water.watched(topic), "the water's knowledge of it")

    def move(self, *motions: tuple[float, Motor]) -> None:
        payload = b"".join(row(time, motor.to_bytes()) for time, motor in motions)
        block = Block.of(BY_NAME["motor"], len(motions), self._number, payload)
        self._number += len(motions)
        self._messages.publish("motor", block.data)

    def hear(self, count: int) -> Sense:
        """Wait for this number of readings; return the last."""
        wait_for(lambda: len(self.senses) >= count, f"{count} words")
        return self.senses[-1]


def motor(angle: float, drive: int = 0) -> Motor:
    return Motor(time=0, wanted=(angle,) * 4, angle=(angle,) * 4, drive=(drive,) * 4)


@pytest.fixture
def simulator() -> Simulator:
    return Simulator(SimulationParameters(), seed=3)


@pytest.fixture
def robot(simulator: Simulator) -> Iterator[FinSender]:
    with (
        tempfile.TemporaryDirectory() as folder,
        ZenohTransport("turtle", [f"unixsock-stream/{folder}/z"]) as here,
    ):
        robot = FinSender(here)
        with join("turtle", [f"unixsock-stream/{folder}/z"]) as there:
            robot.water = there
            loop = HilSimulator(simulator, there)
            thread = threading.Thread(target=loop.run)
            thread.start()
            try:
                wait_for(lambda: here.watched("motor"), "the water's ears")
                yield robot
            finally:
                loop.end()
                thread.join()


def test_it_says_whose_fins_swim_here_and_when_they_are_lost(
    simulator: Simulator, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    caplog.set_level("INFO")
    monkeypatch.setattr(hil, "QUIET", 0.05)
    with (
        tempfile.TemporaryDirectory() as folder,
        ZenohTransport("turtle", [f"unixsock-stream/{folder}/z"]) as here,
        join("turtle", [f"unixsock-stream/{folder}/z"]) as there,
    ):
        loop = HilSimulator(simulator, there)
        thread = threading.Thread(target=loop.run)
        thread.start()
        try:
            wait_for(lambda: "nothing comes from a robot “turtle”" in caplog.text, "its first words")
            wait_for(lambda: here.watched("motor"), "the water's ears")
            FinSender(here).move((100.0, motor(0.0)), (100.02, motor(0.0)))
            wait_for(lambda: "joined the robot “turtle”" in caplog.text, "the words of its arrival")
            wait_for(lambda: "the robot “turtle” is lost" in caplog.text, "the words of its loss")
        finally:
            loop.end()
            thread.join()
    assert f"connected to unixsock-stream/{folder}/z" in caplog.text


def test_the_water_advances_by_the_board_s_clock_only(robot: FinSender) -> None:
    swing = [(100 + n * PERIOD, motor(round(1.2 * sin(n / 6), 3), drive=40)) for n in range(200)]
    for batch in range(4):
        robot.move(*swing[50 * batch : 50 * (batch + 1)])
        last = robot.hear(batch + 1)
    alike = Simulator(SimulationParameters(), seed=3)
    for (_, before), (_, now) in pairwise(swing):
        speed = (now.angle[0] - before.angle[0]) / PERIOD
        reading = alike.advance(PERIOD, FinMotion(now.angle, (speed,) * 4, now.drive, powered=True))
    assert last.pressure == pytest.approx(reading.pressure, abs=20)
    assert last.force == pytest.approx(reading.force, abs=0.05)
    assert last.battery == pytest.approx(reading.battery, abs=0.01)


def test_fins_without_data_for_a_while_count_as_resting(robot: FinSender, simulator: Simulator) -> None:
    robot.move((100.0, motor(0.0)), (100.02, motor(0.0)))
    robot.hear(1)
    before = simulator.truth()
    robot.move((100.02 + GAP_MAX + 5.0, motor(3.0)))
    robot.hear(2)
    after = simulator.truth()
    assert max(map(abs, after.velocity)) < 0.05
    assert after.position[0] == pytest.approx(before.position[0], abs=0.01)


def test_a_clock_that_stands_or_runs_back_advances_nothing(robot: FinSender, simulator: Simulator) -> None:
    robot.move((100.0, motor(0.0)), (100.02, motor(0.0)))
    robot.hear(1)
    before = simulator.truth()
    robot.move((100.02, motor(1.0)), (99.0, motor(2.0)))
    robot.move((99.02, motor(2.0)))
    robot.hear(2)
    moved = max(abs(a - b) for a, b in zip(simulator.truth().position, before.position, strict=True))
    assert moved < 0.001


def test_truth_and_craft_go_on_after_a_reboot_of_the_robot(robot: FinSender) -> None:
    """Its clock then begins near 0 again, and the water goes on."""
    times: dict[str, list[float]] = {"truth": [], "craft": []}

    def see_truth(_: str, data: bytes) -> None:
        times["truth"] += [time for block in read_blocks(data) for time, _ in read_rows(block)]

    def see_craft(_: str, data: bytes) -> None:
        times["craft"] += [json.loads(block.payload)[0]["time"] for block in read_blocks(data)]

    robot.subscribe("truth", see_truth)
    robot.subscribe("craft", see_craft)
    for boot in (5000.0, 30.0):
        robot.move((boot, motor(0.0)), (boot + PERIOD, motor(0.0)))
        for topic, heard in times.items():
            wait_for(partial(heard.__contains__, boot + PERIOD), f"the {topic}")


def test_requests_are_answered_except_bus_errors(simulator: Simulator) -> None:
    with (
        tempfile.TemporaryDirectory() as folder,
        ZenohTransport("turtle", [f"unixsock-stream/{folder}/z"]) as here,
    ):
        HilSimulator(simulator, here)
        here.query("simulator/fault", {"sensor": "pressure", "kind": "stuck"}, SECONDS)
        with pytest.raises(RefusedError, match="has no buses"):
            here.query("simulator/fault", {"sensor": "pressure", "kind": "bus"}, SECONDS)
