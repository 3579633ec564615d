"""The board as a process: its start, its clock, and its end."""

import fcntl
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import pytest

from robot_runtime.simulation.boards.emulator_process import BoardError, EmulatorClient, EmulatorProcess
from tests.board.rig import PROGRAM, ROOT, SKETCHES, wait_for
from tests.waiting import SECONDS

pytestmark = pytest.mark.usefixtures("built")
ECHO = SKETCHES / "echo.elf"


def start(folder: Path, *options: str, elf: Path = ECHO) -> EmulatorProcess:
    return EmulatorProcess(PROGRAM, elf, folder / "tty", folder / "board", *options)


class Look(NamedTuple):
    """The time that a board has kept, with what it has skipped and counted, at a time in between (s)."""

    before: float
    board_time: float
    after: float


def look(board: EmulatorClient) -> Look:
    before = time.monotonic()
    # It may be held up before it answers, by a time of before. Then it looks at the clock, and answers again.
    board.stats()
    stats = board.stats()
    return Look(before, stats["time"] + stats["skipped"], time.monotonic())


def test_it_keeps_real_time(tmp_path: Path) -> None:
    with start(tmp_path) as process, process.connect() as board:
        first, began = look(board), board.stats()["time"]
        wait_for(lambda: board.stats()["time"] - began >= 0.5, "half a second of the board's time")
        last = look(board)
        # On a busy computer it may be behind; beyond a tenth of a second it skips time and counts it.
        stored = last.board_time - first.board_time
        assert last.before - first.after - 0.11 < stored < last.after - first.before + 0.11


def test_time_in_which_it_was_held_up_is_skipped_and_counted(tmp_path: Path) -> None:
    with start(tmp_path) as process, process.connect() as board:
        first, before = look(board), board.stats()
        process.process.send_signal(signal.SIGSTOP)
        begin = time.monotonic()
        wait_for(lambda: time.monotonic() - begin > 0.5, "time to pass")
        process.process.send_signal(signal.SIGCONT)
        # A busy computer may have held it up before, too, for less.
        wait_for(lambda: board.stats()["skipped"] - before["skipped"] > 0.4, "the board to notice")
        assert board.stats()["late"] > before["late"]
        last = look(board)
        assert last.board_time - first.board_time < last.after - first.before + 0.11


def test_it_can_run_faster_than_real_time(tmp_path: Path) -> None:
    with start(tmp_path, "--speed", "0") as process, process.connect() as board:
        leads = []

        def outruns() -> bool:
            leads.append(board.stats()["time"] - time.monotonic())
            # A board that keeps to real time makes up for a tenth of a second at most.
            return max(leads) - min(leads) > 0.2 and leads.index(max(leads)) > leads.index(min(leads))

        wait_for(outruns, "the board to be faster than real time")


def test_a_host_receives_telemetry_in_real_time(tmp_path: Path) -> None:
    with start(tmp_path) as process, process.connect() as board:
        wait_for(lambda: board.stats()["time"] > 0.01, "the sketch to start")
        port = os.open(process.tty, os.O_RDWR | os.O_NOCTTY)
        try:
            os.write(port, b"!")
            assert os.read(port, 1) == b"!"
        finally:
            os.close(port)


def test_run_is_for_paused_boards(tmp_path: Path) -> None:
    with (
        start(tmp_path) as process,
        process.connect() as board,
        pytest.raises(BoardError, match="started with --paused"),
    ):
        board.run(1)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_and_its_files_are_removed(tmp_path: Path, number: signal.Signals) -> None:
    process = start(tmp_path)
    assert process.tty.is_symlink()
    assert process.socket.is_socket()
    process.process.send_signal(number)
    assert process.process.wait(SECONDS) == 0
    process.stop()
    assert list(tmp_path.iterdir()) == []


def test_quit_ends_it(tmp_path: Path) -> None:
    process = start(tmp_path, "--paused")
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(process.socket))
        client.sendall(b"quit\n")
    assert process.process.wait(SECONDS) == 0
    process.stop()
    assert list(tmp_path.iterdir()) == []


def test_it_starts_despite_the_files_of_a_killed_board(tmp_path: Path) -> None:
    process = start(tmp_path)
    process.process.kill()
    process.stop()
    assert process.tty.is_symlink()
    assert process.socket.is_socket()
    with start(tmp_path) as again, again.connect() as board:
        assert board.stats()["resets"] == 1


def test_it_ends_with_its_parent(tmp_path: Path) -> None:
    command = [
        str(PROGRAM),
        *("--elf", str(ECHO), "--tty", str(tmp_path / "tty")),
        *("--socket", str(tmp_path / "board"), "--with-parent"),
    ]
    code = (
        "import subprocess, sys\n"
        "board = subprocess.Popen(sys.argv[1:], stdout=subprocess.PIPE)\n"
        "board.stdout.readline()\n"
        "print(board.pid, flush=True)\n"
        "sys.stdin.read()\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, *command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT
    ) as parent:
        assert parent.stdout
        board = int(parent.stdout.readline())
        assert (tmp_path / "board").is_socket()
        parent.kill()
    wait_for(lambda: not (tmp_path / "board").exists(), f"board {board} to end with its parent")
    assert not (tmp_path / "tty").is_symlink()


def test_it_outlives_its_server_for_the_given_time_at_most(tmp_path: Path) -> None:
    lock = tmp_path / "server.lock"
    with lock.open("w") as server:
        fcntl.flock(server, fcntl.LOCK_EX)
        with start(tmp_path, "--server-lock", str(lock), "--linger", "0") as process:
            with process.connect() as board:
                before = board.stats()["time"]
                # It looks for its server twice a second.
                wait_for(lambda: board.stats()["time"] > before + 1.2, "the board to go on")
            server.close()
            wait_for(lambda: process.process.poll() is not None, "its end")
            assert process.process.returncode == 0
    assert not (tmp_path / "tty").is_symlink()


def test_without_the_server_s_folder_it_ends_at_once(tmp_path: Path) -> None:
    lock = tmp_path / "server.lock"
    lock.touch()
    with start(tmp_path, "--server-lock", str(lock), "--linger", "1000") as process:
        assert process.process.poll() is None
        lock.unlink()
        wait_for(lambda: process.process.poll() is not None, "its end")


def test_two_boards_cannot_share_a_socket(tmp_path: Path) -> None:
    with start(tmp_path) as process:
        with pytest.raises(BoardError, match=r"another board answers at .*choose another --socket"):
            EmulatorProcess(PROGRAM, ECHO, tmp_path / "other", process.socket)
        assert process.socket.is_socket()
        assert not (tmp_path / "other").exists()


@pytest.mark.parametrize(
    ("elf", "tty", "socket_name", "message"),
    [
        ("/nowhere.elf", "tty", "board", "board: cannot read /nowhere.elf: No such file or directory"),
        (__file__, "tty", "board", f"board: {__file__} is not an ELF file for an AVR"),
        (ECHO, "no/tty", "board", "board: cannot create .*/no/tty: No such file or directory"),
        (ECHO, "file", "board", "board: .*/file exists and is not a link"),
        (ECHO, "tty", "file", "board: .*/file exists and is not a socket"),
        (ECHO, "tty", "no/board", "board: cannot listen at .*/no/board: No such file or directory"),
        (ECHO, "tty", "b" * 120, "board: the socket's path is longer than 107 bytes"),
    ],
)
def test_bad_paths_are_refused_in_one_line(
    tmp_path: Path, elf: str | Path, tty: str, socket_name: str, message: str
) -> None:
    (tmp_path / "file").write_text("kept")
    with pytest.raises(BoardError, match=message) as refusal:
        EmulatorProcess(PROGRAM, Path(elf), tmp_path / tty, tmp_path / socket_name)
    assert "\n" not in str(refusal.value)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
    assert (tmp_path / "file").read_text() == "kept"


def test_a_file_that_is_no_eeprom_is_refused_and_left_unchanged(tmp_path: Path) -> None:
    file = tmp_path / "notes"
    file.write_text("kept")
    with pytest.raises(BoardError, match="not an EEPROM of this chip"):
        start(tmp_path, "--eeprom", str(file))
    assert file.read_text() == "kept"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--elf or --bootloader, --tty and --socket are needed"),
        (["--speed", "fast"], "--speed takes a number from 0 to 1000"),
        (["--speed", "-1"], "--speed takes a number from 0 to 1000"),
        (["--tempo", "1"], "unrecognized option '--tempo'"),
        (["more"], "unexpected argument"),
    ],
)
def test_bad_command_lines_are_refused(arguments: list[str], message: str) -> None:
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stdout == ""


def test_help_lists_every_option() -> None:
    done = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True)
    assert done.returncode == 0
    options = {
        "--elf",
        "--bootloader",
        "--tty",
        "--socket",
        "--speed",
        "--paused",
        "--eeprom",
        "--reset-on-open",
        "--with-parent",
        "--server-lock",
        "--linger",
    }
    assert options <= set(done.stdout.replace("[", " ").split())
