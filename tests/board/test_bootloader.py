"""The boot loader on the emulated board, and uploads through the serial port with the real avrdude."""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import serial

from robot_runtime.contract.packets import Hello
from robot_runtime.link.framing import Decoder
from robot_runtime.simulation.boards.emulator_process import (
    STILL_WATER,
    BoardError,
    EmulatorClient,
    EmulatorProcess,
)
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from tests.board.host import BAUD
from tests.board.monitor import REFUSED_ADDRESS, SerialMonitor
from tests.board.rig import (
    OPTIBOOT,
    PROGRAM,
    ROOT,
    SKETCHES,
    BoardRig,
    EmulatedPort,
    build,
    wait_for,
)
from tests.waiting import SECONDS

pytestmark = pytest.mark.usefixtures("built")

ROBOT = ROOT / "build/firmware/robot.hex"
BOOT_BAUD = 115200
TIMEOUT = 131072 / 128e3
"""s; optiboot's watchdog of "1 s", in cycles of the chip's 128 kHz."""
SYNCHRONISE, IN_STEP = b"0 ", b"\x14\x10"
"""STK500: a question that every boot loader answers, and the answer."""
RESET_PIN = 1 << 1
LIMIT = 60.0
"""s of real time for an upload."""


def upload(tty: Path, program: Path, *options: str, baud: int = BOOT_BAUD) -> subprocess.Popen[str]:
    command = ["avrdude", "-c", "arduino", "-p", "m328p", "-b", str(baud), "-D", "-P", str(tty), *options]
    command += ["-U", f"flash:w:{program}:i"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(avrdude: subprocess.Popen[str]) -> tuple[int, str]:
    output, _ = avrdude.communicate(timeout=LIMIT)
    return avrdude.returncode, output


def insist_on_upload(tty: Path, program: Path) -> None:
    status, answer = finish(upload(tty, program))
    assert status == 0, answer
    assert "bytes of flash verified" in answer


@contextmanager
def empty_board(folder: Path) -> Iterator[tuple[EmulatorProcess, EmulatorClient]]:
    """Uploads run in real time, for avrdude waits by its own clock."""
    options = ("--bootloader", str(OPTIBOOT), "--reset-on-open")
    with (
        EmulatorProcess(PROGRAM, None, folder / "tty", folder / "board", *options) as process,
        process.connect() as board,
    ):
        yield process, board


def echoes(process: EmulatorProcess, board: EmulatorClient) -> bool:
    """Return True if the sketch `echo` runs after the boot loader's waiting time."""
    with serial.Serial(str(process.tty), BOOT_BAUD, timeout=SECONDS) as port:
        opened = board.stats()["time"]
        wait_for(lambda: board.stats()["time"] > opened + TIMEOUT + 0.1, "the boot loader's timeout")
        port.write(b"hello")
        return bool(port.read(5) == b"hello")


def both(folder: Path) -> BoardRig:
    return BoardRig(SKETCHES / "monitor.elf", folder, "--bootloader", str(OPTIBOOT))


def test_after_power_on_it_starts_the_program_at_once(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        # It clears the reset cause.
        assert SerialMonitor(rig).boot() == 0
        assert rig.board.stats()["watchdog_resets"] == 0


def test_after_a_reset_it_waits_and_then_starts_the_program(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        SerialMonitor(rig).boot()
        rig.board.reset()
        rig.board.run(TIMEOUT - 0.01)
        assert rig.port.read() == b""
        rig.board.run(0.015)
        assert rig.port.read() == b"R\0"
        assert rig.board.stats()["watchdog_resets"] == 1


def test_after_a_reset_it_listens(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        SerialMonitor(rig).boot()
        rig.board.reset()
        rig.board.run(0.5)
        assert rig.exchange(SYNCHRONISE, 0.01) == IN_STEP
        # After a received byte it waits for the same time again.
        rig.board.run(TIMEOUT - 0.02)
        assert rig.port.read() == b""
        rig.board.run(0.02)
        assert rig.port.read() == b"R\0"


def test_without_a_boot_loader_nothing_waits(tmp_path: Path) -> None:
    with BoardRig(SKETCHES / "monitor.elf", tmp_path) as rig:
        SerialMonitor(rig).boot()
        rig.board.reset()
        assert SerialMonitor(rig).boot() == RESET_PIN


def test_a_signal_pulls_the_reset_pin(tmp_path: Path) -> None:
    with BoardRig(SKETCHES / "monitor.elf", tmp_path) as rig:
        SerialMonitor(rig).boot()
        os.kill(rig.process.process.pid, signal.SIGUSR1)
        wait_for(lambda: rig.board.stats()["resets"] == 2, "the reset")
        assert SerialMonitor(rig).boot() == RESET_PIN


def test_another_program_leaves_the_boot_loader_in_place(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        SerialMonitor(rig).boot()
        rig.board.load(SKETCHES / "echo.elf")
        rig.board.run(0.01)
        assert rig.exchange(SYNCHRONISE, 0.01) == IN_STEP
        rig.board.run(TIMEOUT + 0.01)
        assert rig.exchange(b"hello", 0.01) == b"hello"


def test_a_program_that_reaches_into_the_boot_loader_is_refused(tmp_path: Path) -> None:
    source, elf = tmp_path / "large.c", tmp_path / "large.elf"
    source.write_text(
        "const char filling[32300] __attribute__((progmem, used)) = {1};\nint main(void) { return 0; }\n"
    )
    subprocess.run(["avr-gcc", "-mmcu=atmega328p", "-Os", "-o", elf, source], check=True)
    with both(tmp_path) as rig:
        with pytest.raises(BoardError, match=r"reaches up to 0x7e..; programs have the .* below 0x7e00"):
            rig.board.load(elf)
        assert SerialMonitor(rig).boot() == 0
    with BoardRig(elf, tmp_path) as rig:
        rig.board.run(0.01)
        assert rig.board.stats()["crashes"] == 0


@pytest.mark.stack
def test_avrdude_uploads_a_program_and_then_the_robots(tmp_path: Path) -> None:
    build(ROOT / "firmware", "robot")
    with empty_board(tmp_path) as (process, board):
        insist_on_upload(process.tty, SKETCHES / "echo.hex")
        assert echoes(process, board)
        insist_on_upload(process.tty, ROBOT)
        with serial.Serial(str(process.tty), BAUD, timeout=SECONDS) as port:
            board.reset()
            # Before its hello there may be frames from before the reset, the last one cut off.
            decoder, types = Decoder(), set[int]()
            while Hello.type not in types and (output := port.read_until(b"\0")):
                types |= {type_ for frame in decoder.feed(output) for type_, _ in frame.messages}
        assert Hello.type in types


@pytest.mark.stack
def test_an_interrupted_upload_can_be_done_again(tmp_path: Path) -> None:
    build(ROOT / "firmware", "robot")
    with empty_board(tmp_path) as (process, board):
        # It takes some seconds, so that it has not ended where this test goes on late.
        avrdude = upload(process.tty, ROBOT)
        wait_for(lambda: board.stats()["bytes_to_board"] > 600, "the first pages")
        avrdude.kill()
        finish(avrdude)
        assert avrdude.returncode == -signal.SIGKILL
        insist_on_upload(process.tty, SKETCHES / "echo.hex")
        assert echoes(process, board)


@pytest.mark.stack
def test_an_upload_at_a_wrong_speed_fails_and_changes_nothing(tmp_path: Path) -> None:
    with empty_board(tmp_path) as (process, board):
        insist_on_upload(process.tty, SKETCHES / "echo.hex")
        status, answer = finish(upload(process.tty, SKETCHES / "monitor.hex", "-x", "attempts=2", baud=57600))
        assert status == 1
        assert "not in sync" in answer
        assert board.stats()["framing_errors_board"] > 0
        assert echoes(process, board)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no record\n", "line 1 is no Intel HEX record for this chip"),
        (":0100000000FF\n:00000001FF\n", "it begins at 0x0000, and those begin at 0x7e00"),
        (":017E00000080\n:00000001FF\n", "line 1 is no Intel HEX record"),  # its checksum should be 81
        (":02FFFF000000\n:00000001FF\n", "line 1 is no Intel HEX record"),  # beyond the flash memory
        (":00000001FF\n", "holds no program"),
    ],
)
def test_a_file_that_is_no_boot_loader_is_refused(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "boot.hex"
    file.write_text(text)
    with pytest.raises(BoardError, match=message) as refusal:
        EmulatorProcess(PROGRAM, None, tmp_path / "tty", tmp_path / "board", "--bootloader", str(file))
    assert "\n" not in str(refusal.value)


def test_power_off_and_on_leaves_only_the_memories(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        fresh = rig.board.stats()
        SerialMonitor(rig).boot()
        SerialMonitor(rig).write_eeprom(5, 0x5A)
        rig.board.disturb_line("to_board", "drop", 1.0)
        rig.board.fault("imu", "absent")
        rig.exchange(b"lost", 0.5)
        rig.board.reset()
        rig.board.power()
        rig.port.close()
        rig.port = EmulatedPort(rig.process.tty, rig.board, BOOT_BAUD)
        assert rig.board.stats() == fresh
        monitor = SerialMonitor(rig)
        assert monitor.boot() == 0  # from the boot loader, at once
        assert monitor.read_eeprom(5) == 0x5A
        assert monitor.transfer(0x69, b"\x75", 1)[0] != REFUSED_ADDRESS


def test_the_water_stays_connected_without_power(tmp_path: Path) -> None:
    with both(tmp_path) as rig:
        asked = []

        def feel(motion: FinMotion) -> Reading:
            asked.append(motion)
            return STILL_WATER

        rig.board.attach(0.01, feel)
        rig.board.run(0.055)
        assert len(asked) == 5
        rig.board.power()
        rig.board.run(0.035)
        assert len(asked) == 8
