"""The host's session and the firmware's link against each other, on a line with errors."""

import ctypes
import random
from itertools import pairwise

import pytest

from robot_runtime.contract.packets import (
    BoardEventKind,
    Debug,
    Heartbeat,
    Imu,
    Refusal,
    ResetCause,
    Start,
    Status,
    StatusFlag,
    decode,
)
from robot_runtime.link.session import LinkSession, SessionStage
from tests.firmware.robot import CompiledRobot, read_line
from tests.runtime.link.line import Noise, NoisyWire

REFUSED = bytes([BoardEventKind.REFUSED, Refusal.EPOCH])
"""In each frame that has the event."""

BAUD = 250_000
STEP = 0.005
NOISE = Noise(bits=5e-4, drops=0.05, doubles=0.1, inserts=0.05, bursts=0.05, delay=0.01)
RESTARTS = 300


class Pair:
    """A session of the host and the firmware on a board in memory, with the packets that arrived."""

    def __init__(self, robot: CompiledRobot, seed: int) -> None:
        self.robot = robot
        self.chance = random.Random(seed)
        self.lines: list[Debug] = []
        self.statuses: list[Status] = []
        self.imus = 0
        self._room = ctypes.create_string_buffer(1 << 16)
        self._host_epoch = 0
        self.set_line(NOISE)
        self.restart_host()

    @property
    def now(self) -> float:
        return int(self.robot.firmware.board_now_us()) / 1e6

    @property
    def epoch(self) -> int:
        return int(self.robot.firmware.board_epoch())

    @property
    def joined(self) -> bool:
        board = self.session.board
        established = self.session.stage is SessionStage.ESTABLISHED
        return established and board is not None and board.epoch == self.epoch

    def set_line(self, noise: Noise) -> None:
        self._to_board = NoisyWire(BAUD, noise, self.chance)
        self._to_host = NoisyWire(BAUD, noise, self.chance)

    def restart_host(self) -> None:
        self._host_epoch += 1
        self.session = LinkSession(self._host_epoch, BAUD)
        self.lines.clear()

    def restart_board(self) -> None:
        self.robot.reset(ResetCause.WATCHDOG)
        self.lines.clear()

    def start(self, epoch: int) -> None:
        self._to_board.send(self.session.send([Start(epoch=epoch)], self.now), self.now)

    def beat(self) -> None:
        self._to_board.send(self.session.send([Heartbeat(time=0)], self.now), self.now)

    def run_unheard(self, seconds: float) -> bytes:
        """Run the board without the host; return the bytes that it sends."""
        self.robot.firmware.robot_run(self.robot._robot, round(seconds * 1000))
        size = self.robot.firmware.board_take(self._room, len(self._room))
        return self._room.raw[:size]

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP)):
            self._to_board.send(self.session.poll(self.now), self.now)
            self.robot.send(self._to_board.receive(self.now))
            self.robot.firmware.robot_run(self.robot._robot, round(STEP * 1000))
            size = self.robot.firmware.board_take(self._room, len(self._room))
            self._to_host.send(self._room.raw[:size], self.now)
            for message in self.session.receive(self._to_host.receive(self.now), self.now):
                if line := read_line(decode(message.type, message.payload)):
                    self.lines.append(line)
                elif message.type == Status.type:
                    self.statuses.append(Status.from_bytes(message.payload))
                self.imus += message.type == Imu.type

    def check_lines(self) -> None:
        """Check that no line came twice, and all in order; lines of one moment have distinct texts."""
        assert all(earlier.time <= later.time for earlier, later in pairwise(self.lines))
        assert len({(line.time, line.text) for line in self.lines}) == len(self.lines)


@pytest.fixture
def pair(robot: CompiledRobot) -> Pair:
    return Pair(robot, 3)


def test_on_a_bad_line_every_command_and_every_line_arrives_once_and_in_order(pair: Pair) -> None:
    pair.run(3.0)
    assert pair.joined
    pair.lines.clear()
    for number in range(200):
        pair.start(1000 + number)
        pair.run(0.1)
    pair.set_line(Noise())
    pair.run(2.0)
    assert not pair.session.urgent
    assert {line.text for line in pair.lines} == {"START refused: epoch of another boot"}
    # Where the queue was full, the board reports the number of dropped lines.
    assert len(pair.lines) + pair.statuses[-1].debug_lost == 200
    assert pair.statuses[-1].debug_lost < 10
    assert all(earlier.time <= later.time for earlier, later in pairwise(pair.lines))
    statistics = pair.session.statistics()
    assert statistics.frames_repeated > 10
    assert statistics.frames_invalid > 100


def test_after_an_outage_lines_are_sent_once_again(pair: Pair) -> None:
    """In the outage a line was sent so often that the order of transmissions, 8 bits, has wrapped past it."""
    pair.set_line(Noise(delay=0.03))
    pair.run(2.0)
    pair.start(1000)
    pair.run(0.5)
    pair.robot.send(pair.session.send([Start(epoch=1001)], pair.now))
    copies = 0
    while copies < 160:
        copies += REFUSED in pair.run_unheard(0.01)
    pair.run(1.0)
    before = pair.session.statistics().frames_duplicate
    for number in range(30):
        pair.start(1002 + number)
        for _ in range(20):
            pair.beat()
            pair.run(STEP)
    assert pair.session.statistics().frames_duplicate - before < 5
    assert pair.statuses[-1].debug_lost == 0
    assert [line.text for line in pair.lines].count("START refused: epoch of another boot") == 32


def test_every_gap_in_the_telemetry_is_counted(pair: Pair) -> None:
    pair.set_line(Noise())
    pair.run(1.0)
    before, missed = pair.imus, pair.session.statistics().frames_missed
    pair.set_line(Noise(bursts=0.3))
    pair.run(10.0)
    pair.set_line(Noise())
    pair.run(0.1)
    lost = pair.session.statistics().frames_missed - missed
    # Each tick's frame carries an Imu, and the Status that comes ten times a second has one of its own.
    assert 0 <= lost - (1010 - (pair.imus - before)) < 110
    assert lost > 100


def test_after_any_restart_nothing_comes_twice_and_nothing_is_armed(pair: Pair) -> None:
    joins = 0
    for restart in range(RESTARTS):
        pair.run(pair.chance.uniform(0.0, 0.6))
        if pair.joined:
            joins += 1
            pair.start(pair.epoch)
            pair.run(pair.chance.uniform(0.0, 0.05))
        pair.check_lines()
        pair.chance.choice([pair.restart_host, pair.restart_board])()
        if restart % 10 == 0:
            pair.set_line(Noise())
            pair.run(2.0)
            assert pair.joined
            assert not pair.statuses[-1].flags & StatusFlag.ARMED
            pair.start(9999)
            pair.run(0.2)
            assert pair.lines[-1].text == "START refused: epoch of another boot"
            pair.set_line(NOISE)
    assert joins > RESTARTS // 10
