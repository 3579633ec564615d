"""The lab on the robot's own board, in real time; an emulated board at 1x stands in for the real one."""

import signal
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

import pytest

from robot_runtime.experiments.comm_test.boot_loader import BootLoader, identify
from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.lab import upload_to
from robot_runtime.experiments.comm_test.line import Cancellation
from robot_runtime.experiments.comm_test.reset_pin import ResetError, find_reset
from robot_runtime.experiments.comm_test.runner import BOOTLOADER
from robot_runtime.experiments.comm_test.upload import UploadError
from robot_runtime.link.port import Port
from robot_runtime.link.session import LinkSession, SessionStage
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from tests.board.host import BAUD
from tests.board.rig import ROOT, build, wait_for
from tests.runtime.experiments.comm_test.conftest import make_test
from tests.runtime.experiments.comm_test.lab_process import cancel, lab, read_until, run_lab, write_document

SHORT = make_test(framing="plain", to_val=21, expected=20)
ROBOT = ROOT / "build/firmware/robot.hex"
ATMEGABOOT = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders/atmega/ATmegaBOOT_168_atmega328.hex")


@pytest.fixture
def arduino(program: Path, tmp_path: Path) -> Iterator[EmulatorProcess]:
    """A board with the robot's firmware and a boot loader; opening its port resets it, as on many boards."""
    with start_board(program, tmp_path, "--reset-on-open") as process:
        yield process


@pytest.fixture
def bare_arduino(program: Path, tmp_path: Path) -> Iterator[EmulatorProcess]:
    """A board as on the robot, whose reset pin must be pulled."""
    with start_board(program, tmp_path) as process:
        yield process


def start_board(program: Path, folder: Path, *options: str) -> EmulatorProcess:
    build(ROOT / "firmware", "robot")
    bootloader = () if "--bootloader" in options else ("--bootloader", str(program.parent / BOOTLOADER))
    return EmulatorProcess(
        program, ROBOT.with_suffix(".elf"), folder / "tty", folder / "socket", *bootloader, *options
    )


def board_arguments(arduino: EmulatorProcess, reset: str = "dtr") -> tuple[str, ...]:
    return ("--port", str(arduino.tty), "--reset", reset)


def check_restored(arduino: EmulatorProcess, reset: str = "dtr") -> None:
    """Restore the robot's firmware, and check that it answers a greeting after the boot loader's wait."""
    assert run_lab(b"", "--restore", str(ROBOT), *board_arguments(arduino, reset)) == (0, [])
    session = LinkSession(1, BAUD)
    with Port(str(arduino.tty), BAUD) as port:
        while session.stage is not SessionStage.ESTABLISHED:
            port.write(session.poll(monotonic()))
            if port.wait(session.due() - monotonic()):
                list(session.receive(port.read(), monotonic()))
            assert session.stage is not SessionStage.REFUSED


@pytest.mark.stack
def test_cells_run_and_the_firmware_comes_back(arduino: EmulatorProcess) -> None:
    faulty = make_test(framing="plain", to_val=21, expected=20, faults=Faults(drop=0.1))
    status, events = run_lab(write_document(SHORT, faulty), "--where", "robot", *board_arguments(arduino))
    assert (status, [event["state"] for event in events if event["event"] == "ended"]) == (
        0,
        ["complete"] * 2,
    )
    clean, harmed = (event["values"] for event in events if event["event"] == "cell")
    assert (clean["rate"], clean["bytes_read"]) == (1.0, 40)
    assert harmed["answered"]
    assert harmed["bytes_lost"] > 0
    check_restored(arduino)


@pytest.mark.stack
def test_a_board_whose_reset_pin_is_pulled(bare_arduino: EmulatorProcess) -> None:
    reset = f"board:{bare_arduino.socket}"
    linked = make_test(framing="robot", direction="both", to_val=21, expected=20)
    status, events = run_lab(
        write_document(linked), "--where", "robot", *board_arguments(bare_arduino, reset)
    )
    assert (status, [event["values"]["rate"] for event in events if event["event"] == "cell"]) == (0, [1.0])
    check_restored(bare_arduino, reset)


@pytest.mark.stack
def test_cancelled_in_the_middle_the_firmware_comes_back(arduino: EmulatorProcess) -> None:
    slow = make_test(delay=(10.0,))
    with lab(write_document(slow), "--where", "robot", *board_arguments(arduino)) as process:
        read_until(process.stdout, event="phase", phase="run")
        status, events = cancel(process)
    assert (status, events[-1]["state"]) == (1, "cancelled")
    check_restored(arduino)


@pytest.mark.stack
def test_killed_in_the_middle_of_an_upload_the_firmware_can_be_restored(arduino: EmulatorProcess) -> None:
    with lab(write_document(SHORT), "--where", "robot", *board_arguments(arduino)) as process:
        read_until(process.stdout, event="phase", phase="upload")
        with arduino.connect() as board:
            wait_for(lambda: board.stats()["bytes_to_board"] > 600, "the first pages")
        process.send_signal(signal.SIGKILL)
    check_restored(arduino)


@pytest.mark.parametrize("spec", ["", "gpio", "gpio:4", "gpio:/dev/gpiochip0:x", "board:", "dtr:", "rts"])
def test_an_invalid_reset_is_refused(spec: str) -> None:
    with pytest.raises(ResetError, match="it must be gpio:CHIP:LINE, board:SOCKET or dtr"):
        find_reset(spec)


@pytest.mark.stack
def test_the_boot_loader_of_a_pro_mini_is_refused_before_anything_is_written(
    program: Path, tmp_path: Path
) -> None:
    with start_board(program, tmp_path, "--bootloader", str(ATMEGABOOT)) as arduino:
        pull = find_reset(f"board:{arduino.socket}")
        with pytest.raises(UploadError, match=r"ATmegaBOOT 1\.16 \(57600 bit/s\).*Nothing was written"):
            upload_to(str(arduino.tty), pull, ROBOT, Cancellation())


@pytest.mark.stack
def test_the_boot_loader_is_identified(bare_arduino: EmulatorProcess) -> None:
    pull = find_reset(f"board:{bare_arduino.socket}")
    assert identify(str(bare_arduino.tty), pull) == BootLoader(4, 4, 115200)


@pytest.mark.stack
def test_a_board_without_a_boot_loader_is_not_refused_for_it(program: Path, tmp_path: Path) -> None:
    robot = ROBOT.with_suffix(".elf")
    with EmulatorProcess(program, robot, tmp_path / "tty", tmp_path / "socket") as arduino:
        assert identify(str(arduino.tty), find_reset(f"board:{arduino.socket}")) is None
