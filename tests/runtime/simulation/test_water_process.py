"""The process of the water, with a board that the test plays and the real Zenoh."""

import fcntl
import json
import logging
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract import documents
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.simulation.boards.stepped_board import PERIOD
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water_process import WaterProcess
from robot_runtime.transport.blocks import read_blocks, read_rows
from robot_runtime.transport.zenoh_transport import Answer, ZenohTransport
from tests.runtime.simulation.water.harness import QUIET
from tests.waiting import SECONDS, wait_for

RESTING = b"fins 0 0 0 0 0 0 0 0 0 0 0 0 0 1 1\n"
DIVING = b"fins 0 -1.57 -1.57 -1.57 -1.57 12 12 12 12 40 40 40 40 1 1\n"


def ask(messages: ZenohTransport, name: str, question: dict[str, object]) -> Answer:
    return messages.query(f"simulator/{name}", question, SECONDS)


class SocketBoard:
    """The board's end of the socket, played by the test."""

    def __init__(self, path: Path) -> None:
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(str(path))
        self._listener.listen(1)
        self._listener.settimeout(SECONDS)

    def accept(self) -> str:
        """Wait for a connection of the water; return its first line."""
        self.hang_up()
        self.line, _ = self._listener.accept()
        self.line.settimeout(SECONDS)
        self._reader = self.line.makefile("r")
        return self.hear()

    def hear(self) -> str:
        return self._reader.readline().strip()

    def exchange(self, fins: bytes = RESTING) -> list[float]:
        """Return the numbers in the water's answer to a line, without its lines about devices."""
        self.line.sendall(fins)
        while (answer := self.hear()).startswith("fault "):
            pass
        word, *numbers = answer.split()
        assert word == "sense"
        assert len(numbers) == 16
        return [float(number) for number in numbers]

    def hang_up(self) -> None:
        if hasattr(self, "line"):
            self._reader.close()
            self.line.close()

    def close(self) -> None:
        self.hang_up()
        self._listener.close()


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder with a path short enough for a Unix socket."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)


@pytest.fixture
def board(folder: Path) -> Iterator[SocketBoard]:
    made = SocketBoard(folder / "board")
    yield made
    made.close()


@pytest.fixture
def messages(folder: Path) -> Iterator[ZenohTransport]:
    with ZenohTransport("turtle", listen=[f"unixsock-stream/{folder}/zenoh"]) as made:
        yield made


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(100.0)


@pytest.fixture
def process(
    folder: Path, board: SocketBoard, messages: ZenohTransport, clock: SimulatedClock
) -> Iterator[WaterProcess]:
    del board
    made = WaterProcess(Simulator(QUIET, seed=1), folder / "board", messages, clock)
    thread = threading.Thread(target=made.run)
    thread.start()
    yield made
    made.end()
    thread.join(SECONDS)
    assert not thread.is_alive()


@pytest.mark.usefixtures("process")
class TestAttached:
    def test_attaches_and_answers_every_line(self, board: SocketBoard) -> None:
        assert board.accept() == f"attach {PERIOD}"
        pressures = [board.exchange()[0] for _ in range(20)]
        assert all(pressure == 101325 for pressure in pressures)

    def test_the_robot_moves_as_the_fins_push(self, board: SocketBoard) -> None:
        board.accept()
        first = board.exchange()[0]
        for _ in range(200):
            last = board.exchange(DIVING)[0]
        assert last > first + 500

    def test_lines_that_come_in_pieces_or_together(self, board: SocketBoard) -> None:
        board.accept()
        board.exchange()
        for piece in (RESTING[:9], RESTING[9:20], RESTING[20:] + RESTING):
            board.line.sendall(piece)
        assert board.hear().startswith("sense ")
        assert board.hear().startswith("sense ")

    def test_error_lines_are_logged_and_not_answered(
        self, board: SocketBoard, caplog: pytest.LogCaptureFixture
    ) -> None:
        board.accept()
        with caplog.at_level(logging.WARNING):
            board.line.sendall(b"error no such thing\n")
            board.exchange()
        assert "no such thing" in caplog.text

    @pytest.mark.parametrize("garbage", [b"fins 1 2 3\n", b"hello\n", b"x" * 2000])
    def test_after_garbage_it_reconnects(self, board: SocketBoard, garbage: bytes) -> None:
        board.accept()
        board.line.sendall(garbage)
        assert board.hear() == ""
        assert board.accept() == f"attach {PERIOD}"
        board.exchange()

    def test_it_reconnects_with_the_board_and_continues_the_motion(
        self, board: SocketBoard, caplog: pytest.LogCaptureFixture
    ) -> None:
        board.accept()
        for _ in range(200):
            deep = board.exchange(DIVING)[0]
        with caplog.at_level(logging.INFO):
            board.hang_up()
            board.accept()
            assert board.exchange()[0] > deep - 200
            # It answers first, and reports then.
            wait_for(lambda: len(caplog.records) >= 2, "word of both")
        assert [record.levelname for record in caplog.records] == ["WARNING", "INFO"]

    def test_a_missing_board_is_reported_once(
        self, board: SocketBoard, caplog: pytest.LogCaptureFixture
    ) -> None:
        for _ in range(3):
            board.accept()
        board.exchange()
        assert caplog.text.count("no board at") == 1

    def test_truth_comes_twenty_times_a_second(
        self, board: SocketBoard, messages: ZenohTransport, clock: SimulatedClock
    ) -> None:
        received: list[bytes] = []
        subscription = messages.subscribe("truth", lambda _, payload: received.append(payload))
        board.accept()
        for _ in range(201):
            board.exchange(DIVING)
            clock.forward(PERIOD)
        wait_for(lambda: len(received) >= 20, "truth")
        subscription.close()
        blocks = [block for payload in received for block in read_blocks(payload)]
        rows = [row for block in blocks for row in read_rows(block)]
        assert [block.first for block in blocks] == list(range(len(blocks)))
        times = [time for time, _ in rows]
        assert len(times) in (20, 21)
        assert times == pytest.approx([100 + 0.05 * index for index in range(len(times))], abs=PERIOD)
        last = rows[-1][1]
        assert isinstance(last, documents.Truth)
        assert last.position[2] > 0.06
        assert last.fins == pytest.approx((-1.57,) * 4)

    def test_no_truth_is_repeated_after_the_board_was_away(
        self, board: SocketBoard, messages: ZenohTransport, clock: SimulatedClock
    ) -> None:
        received: list[bytes] = []
        subscription = messages.subscribe("truth", lambda _, payload: received.append(payload))
        board.accept()
        board.exchange()
        clock.forward(60)
        for _ in range(5):
            board.exchange()
        clock.forward(0.05)
        board.exchange()
        wait_for(lambda: len(received) >= 3, "truth")
        board.exchange()
        subscription.close()
        assert len(received) == 3

    def test_the_craft_is_sent_with_the_first_truth_and_every_ten_seconds(
        self, board: SocketBoard, messages: ZenohTransport, clock: SimulatedClock
    ) -> None:
        received: list[bytes] = []
        subscription = messages.subscribe("craft", lambda _, payload: received.append(payload))
        board.accept()
        board.exchange()
        clock.forward(9.0)
        board.exchange()
        clock.forward(1.0)
        board.exchange()
        wait_for(lambda: len(received) >= 2, "the craft")
        subscription.close()
        sent = [json.loads(block.payload)[0] for payload in received for block in read_blocks(payload)]
        assert [(document["time"], document["title"]) for document in sent] == [
            (100.0, "Default craft, changed"),
            (110.0, "Default craft, changed"),
        ]
        assert sent[0]["craft"]["pressure"]["noise"] == 0

    def test_reset_brings_it_back_to_the_surface(self, board: SocketBoard, messages: ZenohTransport) -> None:
        board.accept()
        surface = board.exchange()[0]
        for _ in range(200):
            board.exchange(DIVING)
        assert ask(messages, "reset", {}) == {"accepted": True}
        assert board.exchange()[0] == pytest.approx(surface, abs=5)

    def test_current_carries_it_away(self, board: SocketBoard, messages: ZenohTransport) -> None:
        answer = ask(messages, "current", {"north": 1, "east": -0.5, "down": 0.0})
        assert answer == {"accepted": True}
        board.accept()
        forces = [board.exchange()[2] for _ in range(5)]
        assert min(forces) > 1.0

    @pytest.mark.parametrize(
        "question",
        [
            {},
            {"north": 1, "east": 0},
            {"north": 1, "east": 0, "down": 0, "up": 1},
            {"north": "1", "east": 0, "down": 0},
            {"north": True, "east": 0, "down": 0},
            {"north": None, "east": 0, "down": 0},
            {"north": 3, "east": 0, "down": 0},
            {"north": 10**400, "east": 0, "down": 0},
        ],
    )
    def test_impossible_currents_are_refused(
        self, messages: ZenohTransport, question: dict[str, object]
    ) -> None:
        with pytest.raises(RefusedError, match=r"is missing|is not known here|number|at most 2 m/s"):
            ask(messages, "current", question)

    def test_bus_errors_are_sent_once_to_each_board(
        self, board: SocketBoard, messages: ZenohTransport
    ) -> None:
        board.accept()
        board.exchange()
        ask(messages, "fault", {"sensor": "gyroscope", "kind": "bus"})
        ask(messages, "fault", {"sensor": "encoder1", "kind": "bus"})
        board.line.sendall(RESTING)
        assert board.hear() == "fault encoder1 absent"
        assert board.hear() == "fault imu absent"
        assert board.hear().startswith("sense ")
        board.line.sendall(b"ok\nok\n")
        board.exchange()
        ask(messages, "fault", {"sensor": "gyroscope", "kind": "none"})
        board.line.sendall(RESTING)
        assert board.hear() == "fault imu none"
        assert board.hear().startswith("sense ")
        # Another board may have faults of an earlier simulator, or none of this one's.
        board.accept()
        board.line.sendall(RESTING)
        assert board.hear() == "fault encoder1 absent"
        repaired = [board.hear() for _ in range(6)]
        assert repaired == [
            f"fault {device} none"
            for device in ("encoder0", "encoder2", "encoder3", "imu", "leak", "pressure")
        ]
        assert board.hear().startswith("sense ")

    @pytest.mark.parametrize(
        ("name", "question"),
        [
            ("waves", {"amplitude": 0.1, "period": 3, "direction": 0.5}),
            ("trim", {"buoyancy": 1.01, "forward": 0, "right": 0, "above": 0.01}),
            ("world", {"depth": 2, "length": 8, "width": 4}),
            ("beacons", {"positions": [[2, 0, 0.5]]}),
            ("fault", {"sensor": "battery", "kind": "drift", "speed": -0.1}),
        ],
    )
    def test_every_request_works_over_zenoh(
        self, messages: ZenohTransport, name: str, question: dict[str, object]
    ) -> None:
        assert ask(messages, name, question) == {"accepted": True}
        with pytest.raises(RefusedError, match="is missing"):
            ask(messages, name, {})

    def test_reset_takes_no_depth(self, messages: ZenohTransport) -> None:
        with pytest.raises(RefusedError, match="'depth' is not known here"):
            ask(messages, "reset", {"depth": 1})


def command(folder: Path, *more: str) -> list[str]:
    endpoint = f"unixsock-stream/{folder}/zenoh"
    program = [sys.executable, "-m", "robot_runtime.simulation"]
    return [*program, "--board", str(folder / "board"), "--connect", endpoint, "--robot", "turtle", *more]


@contextmanager
def started(folder: Path, *more: str) -> Iterator[subprocess.Popen[str]]:
    """The simulator's process, which also a test that fails does not wait for."""
    with subprocess.Popen(command(folder, *more), stderr=subprocess.PIPE, text=True) as program:
        try:
            yield program
        finally:
            program.kill()


def accepted(messages: ZenohTransport) -> bool:
    try:
        return messages.query("simulator/reset", {}, timeout=0.5) == {"accepted": True}
    except NoAnswerError:
        return False


def test_the_program_runs_and_ends_on_sigterm(
    folder: Path, board: SocketBoard, messages: ZenohTransport
) -> None:
    with started(folder, "--seed", "2") as program:
        assert board.accept() == f"attach {PERIOD}"
        board.exchange()
        wait_for(lambda: accepted(messages), "answer")
        program.send_signal(signal.SIGTERM)
        assert program.wait(SECONDS) == 0


def test_program_waits_for_board_and_peers_that_are_not_there(folder: Path) -> None:
    with started(folder) as program:
        assert program.stderr is not None
        assert "no board at" in program.stderr.readline()
        late = SocketBoard(folder / "board")
        late.accept()
        late.exchange()
        late.close()
        with ZenohTransport("turtle", listen=[f"unixsock-stream/{folder}/zenoh"]) as messages:
            wait_for(lambda: accepted(messages), "answer")
        program.send_signal(signal.SIGTERM)
        assert program.wait(SECONDS) == 0


def test_program_ends_some_time_after_its_server(folder: Path, board: SocketBoard) -> None:
    lock = folder / "server.lock"
    with lock.open("w") as server:
        fcntl.flock(server, fcntl.LOCK_EX)
        with started(folder, "--server-lock", str(lock), "--linger", "0") as program:
            board.accept()
            board.exchange()
            assert program.poll() is None
            server.close()
            assert board.hear() == ""
            assert program.wait(SECONDS) == 0


def test_program_ends_with_its_parent(folder: Path, board: SocketBoard) -> None:
    parent = "import subprocess, sys; subprocess.Popen(sys.argv[1:]); sys.stdin.read()"
    arguments = [sys.executable, "-c", parent, *command(folder, "--with-parent")]
    with subprocess.Popen(arguments, stdin=subprocess.PIPE) as item:
        board.accept()
        os.kill(item.pid, signal.SIGKILL)
    assert board.hear() == ""
