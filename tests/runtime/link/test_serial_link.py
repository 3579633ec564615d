"""The serial link over a real pseudo-terminal, whose far end the test plays."""

import errno
import os
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.packets import Debug, Depth, Heartbeat, Hello, Parameter, Stop
from robot_runtime.link.framing import build
from robot_runtime.link.link_driver import PortError
from robot_runtime.link.port import Port, list_ports
from robot_runtime.link.serial_link import SerialLink
from robot_runtime.link.session import BoardMessage
from tests.runtime.board_end import BoardEnd, hello
from tests.waiting import SECONDS

LOOK = 0.1
"""s; the link looks at its clock twice as often at least."""


class PatientClock:
    """A steady clock that stands while this process is held: so is the board, which the test plays."""

    def __init__(self) -> None:
        self._steady = SteadyClock()
        self._seen = self._steady.now()
        self._held = 0.0
        self._lock = threading.Lock()

    def now(self) -> float:
        with self._lock:
            before, self._seen = self._seen, self._steady.now()
            self._held += max(self._seen - before - LOOK, 0.0)
            return self._seen - self._held


class LinkedHost:
    """A serial link and its reports."""

    def __init__(self, path: Path, *, in_step: bool = False) -> None:
        self.texts: list[str] = []
        self.threads: set[threading.Thread] = set()
        self.messages: list[BoardMessage] = []
        self.mistakes = 0
        self._changed = threading.Condition()
        self.connection = SerialLink(
            str(path), 250_000, PatientClock(), 1, self._take, self._change, in_step=in_step
        )

    def wait(self, condition: Callable[[], bool]) -> None:
        with self._changed:
            assert self._changed.wait_for(condition, SECONDS), self.connection.text

    def _change(self) -> None:
        self.texts.append(self.connection.text)
        self._wake()

    def _take(self, messages: list[BoardMessage]) -> None:
        if self.mistakes:
            self.mistakes -= 1
            raise ZeroDivisionError
        self.threads.add(threading.current_thread())
        self.messages += messages
        self._wake()

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify_all()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "board.tty"


@pytest.fixture
def host(path: Path) -> Iterator[LinkedHost]:
    host = LinkedHost(path)
    host.connection.start()
    yield host
    host.connection.close()


def connect(board: BoardEnd, host: LinkedHost) -> None:
    for _ in range(2):
        board.hear(Hello.type)
        board.say(hello())
    # It is connected a moment before it says so.
    host.wait(lambda: host.connection.connected and host.texts[-1] == "connected")


def test_a_missing_port_is_awaited_and_reported(host: LinkedHost, path: Path) -> None:
    host.wait(lambda: "does not exist" in host.connection.text)
    assert not host.connection.send(Stop())
    connect(BoardEnd(path), host)
    assert host.connection.text == "connected"


def test_packets_pass_both_ways(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, host)
    assert host.connection.send(Stop())
    board.hear(Stop.type)
    board.say(Debug(time=5, level=1, text="dive"))
    host.wait(lambda: any(message.type == Debug.type for message in host.messages))
    assert host.connection.statistics().frames_received == 3


def test_the_port_stays_open_while_the_board_pauses(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, host)
    report = len(host.texts)
    for _ in range(4):
        board.hear(Heartbeat.type)
    assert host.connection.connected
    assert len(host.texts) == report


def test_a_port_that_vanishes_and_returns_is_reopened(host: LinkedHost, path: Path) -> None:
    first = BoardEnd(path)
    connect(first, host)
    first.vanish()
    host.wait(lambda: not host.connection.connected)
    second = BoardEnd(path)
    connect(second, host)
    second.say(Debug(time=5, level=1, text="back"))
    host.wait(lambda: any(message.payload.endswith(b"back") for message in host.messages))


def test_after_an_error_in_what_handles_its_messages_the_link_comes_back(
    host: LinkedHost, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    board = BoardEnd(path)
    connect(board, host)
    host.mistakes = 1
    board.say(Debug(time=5, level=1, text="dive"))
    host.wait(lambda: any("an error in the software" in text for text in host.texts))
    assert "ZeroDivisionError" in caplog.text
    connect(board, host)


def test_the_last_frames_are_logged_when_the_port_vanishes(
    host: LinkedHost, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    board = BoardEnd(path)
    connect(board, host)
    caplog.set_level("INFO")
    board.say(Debug(time=5, level=1, text="farewell"))
    host.wait(lambda: any(message.type == Debug.type for message in host.messages))
    board.vanish()
    host.wait(lambda: not host.connection.connected)
    (dump,) = [record.getMessage() for record in caplog.records if "last frames" in record.getMessage()]
    assert b"farewell".hex() in dump
    assert " -> " in dump
    fault = host.connection.fault
    assert fault is not None
    assert fault.text == "the port went away"
    assert any(b"farewell" in frame.stuffed for frame in fault.frames)
    assert {frame.sent for frame in fault.frames} == {True, False}


def test_a_line_of_text_is_acknowledged_soon(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, host)
    board.say(Debug(time=5, level=1, text="heard?"))
    board.hear_until(lambda: not board.waiting)
    assert [message.payload[6:] for message in host.messages if message.type == Debug.type] == [b"heard?"]


def test_garbage_on_the_line_is_counted_and_survived(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, host)
    os.write(
        board.master,
        b"\x07garbage\x00" + bytes([0xFF]) * 300 + b"\x00" + build([hello()], 1, 0)[:-3] + b"\x00",
    )
    board.say(Debug(time=5, level=1, text="still here"))
    host.wait(lambda: any(message.payload.endswith(b"still here") for message in host.messages))
    assert host.connection.statistics().frames_invalid == 3


def test_bytes_without_a_frame_lead_to_a_hint_at_the_speed(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    board.hear(Hello.type)
    os.write(board.master, bytes([0x80, 0xF8, 0xE0, 0x00]) * 100)
    host.wait(lambda: "bytes come from the board, but no valid frame" in host.connection.text)
    assert "250000 baud" in host.connection.text
    connect(board, host)
    assert host.connection.text == "connected"


def test_other_definitions_are_refused_with_the_reason(host: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    board.hear(Hello.type)
    board.say(hello(definitions=0x1234ABCD))
    host.wait(lambda: "1234abcd" in host.connection.text and "make firmware" in host.connection.text)
    assert not host.connection.connected


def test_a_port_in_use_is_named(path: Path) -> None:
    BoardEnd(path)
    with Port(str(path), 115_200), pytest.raises(PortError, match="in use by another program"):
        Port(str(path), 115_200)


def test_a_port_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(PortError, match=r"tty does not exist: is the board .* link\.port right.* there: "):
        Port(str(tmp_path / "tty"), 115_200)


def test_the_ports_that_are_there_are_listed_once_by_the_name_that_stays(tmp_path: Path) -> None:
    for name in ("ttyUSB1", "ttyAMA0", "ttyS0", "ttyS1", "tty7", "null"):
        (tmp_path / name).touch()
    (tmp_path / "serial/by-id").mkdir(parents=True)
    (tmp_path / "serial/by-id/usb-1a86").symlink_to("../../ttyUSB1")
    (tmp_path / "serial0").symlink_to("ttyAMA0")
    assert list_ports(tmp_path) == [
        str(tmp_path / path) for path in ("serial/by-id/usb-1a86", "serial0", "ttyS0")
    ]


def test_a_port_without_permission_names_the_group(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> int:
        raise PermissionError(errno.EACCES, "Permission denied")

    # For root, who may run these tests, no file is closed.
    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(PortError, match="may not be opened: add this user to the group dialout"):
        Port(str(path), 115_200)


@pytest.fixture
def line() -> Iterator[tuple[str, int]]:
    """Path of a port, and the descriptor of its far end."""
    far, near = os.openpty()
    yield os.ttyname(near), far
    os.close(near)
    os.close(far)


def test_a_late_process_is_not_taken_for_a_full_line(
    line: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, far = line
    write = os.write

    def write_and_be_late(descriptor: int, data: bytes) -> int:
        written = write(descriptor, data)
        time.sleep(0.3)
        return written

    monkeypatch.setattr("os.write", write_and_be_late)
    with Port(path, 115_200) as port:
        port.write(b"on its way")
    assert os.read(far, 64) == b"on its way"


def test_a_line_that_stays_full_is_named(line: tuple[str, int]) -> None:
    path, _ = line
    with Port(path, 115_200) as port, pytest.raises(PortError, match="no more bytes: it stayed full"):
        port.write(bytes(1_000_000))


@pytest.fixture
def stepped(path: Path) -> Iterator[LinkedHost]:
    host = LinkedHost(path, in_step=True)
    host.connection.start()
    yield host
    host.connection.close()


def say_in_step(board: BoardEnd, host: LinkedHost, depth: float) -> None:
    """Send a depth as the board, and run steps until it is there."""
    board.say(Depth(time=1, depth=depth, pressure=100_000, temperature=20.0))
    end, count = time.monotonic() + SECONDS, len(host.messages)
    while len(host.messages) == count:
        assert time.monotonic() < end, host.connection.text
        host.connection.receive_waiting(0.02)
        host.connection.send_due()


def test_in_step_the_bytes_are_handled_by_the_steps_thread(stepped: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, stepped)
    say_in_step(board, stepped, 0.1)
    stepped.threads.clear()
    for depth in (0.2, 0.3, 0.4):
        say_in_step(board, stepped, depth)
    assert stepped.threads == {threading.current_thread()}


def test_without_steps_the_links_thread_reads(stepped: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, stepped)
    say_in_step(board, stepped, 0.1)
    board.say(Debug(time=5, level=1, text="alone"))
    stepped.wait(lambda: any(message.payload.endswith(b"alone") for message in stepped.messages))
    board.hear(Heartbeat.type)


def test_what_is_reliable_is_acknowledged_without_a_step(stepped: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, stepped)
    say_in_step(board, stepped, 0.1)
    assert stepped.connection.send(Parameter(number=0, value=1.0))
    board.hear(Parameter.type)
    board.say(Parameter(number=0, value=1.0))
    board.hear_until(lambda: not board.waiting)
    stepped.wait(lambda: any(message.type == Parameter.type for message in stepped.messages))


def test_an_error_in_a_step_ends_the_session_and_the_link_comes_back(
    stepped: LinkedHost, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    board = BoardEnd(path)
    connect(board, stepped)
    say_in_step(board, stepped, 0.1)
    stepped.mistakes = 1
    board.say(Depth(time=1, depth=0.2, pressure=100_000, temperature=20.0))
    end = time.monotonic() + SECONDS
    while stepped.mistakes and time.monotonic() < end:
        stepped.connection.receive_waiting(0.02)
    stepped.wait(lambda: any("an error in the software" in text for text in stepped.texts))
    assert "ZeroDivisionError" in caplog.text
    connect(board, stepped)


def test_a_port_that_vanishes_is_noticed_in_a_step(stepped: LinkedHost, path: Path) -> None:
    board = BoardEnd(path)
    connect(board, stepped)
    say_in_step(board, stepped, 0.1)
    board.vanish()
    end = time.monotonic() + SECONDS
    while stepped.connection.connected and time.monotonic() < end:
        stepped.connection.receive_waiting(0.02)
    stepped.wait(lambda: not stepped.connection.connected)
    connect(BoardEnd(path), stepped)
