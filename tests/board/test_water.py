"""The lockstep of board and water, and the commands on the socket."""

import contextlib
import socket
import struct
import time
from pathlib import Path

import pytest

from robot_runtime.simulation.boards.emulator_process import (
    STILL_WATER,
    BoardError,
    EmulatorClient,
    EmulatorProcess,
)
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from tests.board.conftest import Make
from tests.board.monitor import SerialMonitor
from tests.board.rig import PROGRAM, SKETCHES, wait_for
from tests.waiting import SECONDS


def test_the_water_is_asked_at_every_period(make_rig: Make) -> None:
    rig = make_rig("echo")
    asked: list[FinMotion] = []

    def water(fins: FinMotion) -> Reading:
        asked.append(fins)
        return STILL_WATER

    rig.board.attach(0.005, water)
    rig.board.run(1.0)
    assert len(asked) == 200
    assert {fins.angles for fins in asked} == {(0.05, -0.04, 0.03, -0.06)}
    assert rig.board.stats()["sense_late"] == 0


def test_the_answer_applies_before_time_advances(make_rig: Make) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    monitor.transfer(0x69, b"\x6b\0")
    count = 0

    def water(_: FinMotion) -> Reading:
        nonlocal count
        count += 1
        return STILL_WATER._replace(rate=(count * 0.01, 0.0, 0.0))

    rig.board.attach(0.005, water)
    output = rig.exchange(b"T" + bytes([0x69, 1, 0x43, 2]), 0.05)
    # The transfer was over before the first answer; the next one sees the answers until then.
    assert output[-2:] == b"\0\0"
    assert count == 10
    output = rig.exchange(b"T" + bytes([0x69, 1, 0x43, 2]), 0.05)
    (counts,) = struct.unpack(">h", output[-2:])
    assert counts == round(10 * 0.01 * 131.072 * 57.29577951308232)


def test_a_paused_board_waits_for_the_water(make_rig: Make) -> None:
    rig = make_rig("echo")
    path = rig.process.socket
    with socket.socket(socket.AF_UNIX) as water:
        water.connect(str(path))
        water.sendall(b"attach 0.01\n")
        wait_for(lambda: refused(rig.board), "the water to be attached")
        with EmulatorClient(path) as runner, socket.socket(socket.AF_UNIX) as line:
            line.connect(str(path))
            line.sendall(b"run 0.03\n")
            fins = water.recv(4096)
            assert fins.startswith(b"fins 0.0100")
            for _ in range(3):
                assert runner.stats()["time"] == pytest.approx(0.01, abs=1e-6)
            for _ in range(3):
                water.sendall(b"sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4\n")
                if runner.stats()["time"] < 0.0299:
                    assert water.recv(4096).startswith(b"fins")
            assert line.recv(4096).startswith(b"ok 0.03")


def test_there_is_one_water(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.attach(0.005, lambda _: STILL_WATER)
    with rig.process.connect() as other:
        with pytest.raises(BoardError, match="another connection is the water"):
            other.attach(0.005, lambda _: STILL_WATER)
        with pytest.raises(BoardError, match="another connection is the water"):
            other.sense(STILL_WATER)
        assert other.stats()["time"] == 0
    with pytest.raises(BoardError, match="attach takes a period"):
        rig.board.attach(2.0, lambda _: STILL_WATER)
    assert rig.board.run(0.01) == pytest.approx(0.01, abs=1e-6)


def refused(board: EmulatorClient) -> bool:
    try:
        board.sense(STILL_WATER)
    except BoardError as error:
        return "another connection is the water" in str(error)
    return False


def test_after_losing_the_water_the_board_runs_on_with_the_last_values(make_rig: Make) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    with rig.process.connect() as water:
        water.attach(0.001, lambda _: STILL_WATER._replace(beacon_left=True))
        water.run(0.002)
    rig.board.run(0.1)
    assert monitor.inputs() & (1 << 5)
    wait_for(lambda: not refused(rig.board), "another connection to be let in as the water")


@pytest.mark.usefixtures("built")
def test_a_board_in_real_time_waits_50_ms_and_then_continues(tmp_path: Path) -> None:
    with (
        EmulatorProcess(PROGRAM, SKETCHES / "echo.elf", tmp_path / "tty", tmp_path / "board") as process,
        socket.socket(socket.AF_UNIX) as water,
        process.connect() as board,
    ):
        water.connect(str(process.socket))
        begin = time.monotonic()
        water.sendall(b"attach 0.005\n")
        wait_for(lambda: board.stats()["sense_late"] >= 3, "answers that never come to be missed")
        assert time.monotonic() - begin >= 3 * 0.05


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("dance", "unknown command"),
        ("", "unknown command"),
        ("attach", "attach takes a period"),
        ("attach 0", "attach takes a period"),
        ("attach 0.005x", "attach takes a period"),
        ("attach nan", "attach takes a period"),
        ("sense 1 2 3", "sense takes eleven finite numbers"),
        ("sense nan 20 0 0 -9.81 0 0 0 0 0 7.4", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 1", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 x", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 nan 0 7.4", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 0 0 0", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 0 0 0 4", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 0 0 0 inf", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 0 0 0 0 -1", "sense takes eleven finite numbers"),
        ("sense 101325 20 0 0 -9.81 0 0 0 0 0 7.4 0 0 0 0 1 1", "sense takes eleven finite numbers"),
        ("sense -1 20 0 0 -9.81 0 0 0 0 0 7.4", "sense takes eleven finite numbers"),
        ("run", "run takes a number of seconds"),
        ("run -1", "run takes a number of seconds"),
        ("run inf", "run takes a number of seconds"),
        ("fault imu", "fault takes imu"),
        ("load /nowhere", "cannot read /nowhere"),
    ],
)
def test_bad_commands_are_refused_with_a_reason(make_rig: Make, line: str, reason: str) -> None:
    rig = make_rig("echo")
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(rig.process.socket))
        client.sendall(line.encode() + b"\n")
        answer = client.recv(4096).decode()
    assert answer.startswith("error " + reason)
    assert rig.board.run(0.001) == pytest.approx(0.001, abs=1e-6)


def test_commands_may_come_in_pieces_or_several_at_once(make_rig: Make) -> None:
    rig = make_rig("echo")
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(rig.process.socket))
        for piece in (b"fau", b"lt imu abs", b"ent\nfault imu none\nst", b"ats\n"):
            client.sendall(piece)
            rig.board.stats()  # it has been read by now
        answer = b""
        while answer.count(b"\n") < 3:
            answer += client.recv(4096)
    assert answer.startswith(b"ok\nok\nstats time=0.000000 ")


def test_a_line_without_an_end_closes_the_connection(make_rig: Make) -> None:
    rig = make_rig("echo")
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(rig.process.socket))
        client.sendall(b"x" * 3000)
        client.settimeout(SECONDS)
        with contextlib.suppress(ConnectionResetError):  # where bytes were left unread
            assert client.recv(4096) == b""
    assert rig.board.stats()["resets"] == 1
