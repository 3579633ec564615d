"""The reset pin through the real libgpiod: on a fake chip, and on the kernel's gpio-sim."""

import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test.reset_pin import PULSE, ResetError, find_reset
from robot_runtime.experiments.comm_test.runner import BOOTLOADER
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from tests.board.rig import ROOT, build
from tests.runtime.experiments.comm_test.gpio_chip import GpioChip
from tests.runtime.experiments.comm_test.lab_process import run_lab

pytestmark = pytest.mark.stack
"""avrdude waits by its own clock."""

LINE = 4
GPIO_SIM = Path("/sys/kernel/config/gpio-sim")
PULL = """
import sys
from robot_runtime.experiments.comm_test.reset_pin import ResetError, find_reset
try:
    find_reset(sys.argv[1])()
except ResetError as problem:
    sys.exit(str(problem))
"""


@pytest.fixture
def chip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> GpioChip:
    return GpioChip(tmp_path, monkeypatch)


def pull(spec: str) -> str:
    """Return the error of a process that pulls the pin; empty without one."""
    done = subprocess.run([sys.executable, "-c", PULL, spec], cwd=ROOT, capture_output=True, text=True)
    return done.stderr.strip()


def test_the_pin_is_low_for_the_pulse_then_high_and_free_again(chip: GpioChip) -> None:
    assert pull(f"gpio:{chip.path}:{LINE}") == ""
    levels = chip.levels(LINE)
    assert [what for what, _ in levels] == ["output", "low", "high", "released"]
    low, high = (time for what, time in levels if what in ("low", "high"))
    assert high - low >= PULSE
    assert [chip.levels(other) for other in range(8) if other != LINE] == [[]] * 7


def test_a_chip_that_is_not_there_is_named(chip: GpioChip) -> None:
    missing = chip.path.with_name("gpiochip9")
    answer = f"the reset pin, line 4 of {missing}, cannot be pulled: [Errno 2] No such file or directory"
    assert pull(f"gpio:{missing}:{LINE}") == answer


def test_a_line_that_the_chip_lacks_is_named(chip: GpioChip) -> None:
    answer = pull(f"gpio:{chip.path}:8")
    assert answer.startswith(f"the reset pin, line 8 of {chip.path}, cannot be pulled: ")
    assert "range" in answer


def test_a_line_that_another_program_holds_is_not_pulled(chip: GpioChip) -> None:
    with chip.hold(LINE):
        answer = pull(f"gpio:{chip.path}:{LINE}")
    assert answer == (
        f"the reset pin, line 4 of {chip.path}, cannot be pulled: [Errno 16] Device or resource busy"
    )
    assert chip.levels(LINE) == []


def test_without_the_package_its_installation_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gpiod", None)
    with pytest.raises(ResetError, match=r"gpiod is missing: `pip install mucat\[pi\]` brings it"):
        find_reset("gpio:/dev/gpiochip0:4")()


def test_an_upload_resets_the_board_before_avrdude_begins(
    chip: GpioChip, program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    build(ROOT / "firmware", "robot")
    robot = ROOT / "build/firmware/robot.hex"
    put_before_avrdude(tmp_path, f'cp "{tmp_path}/lines/{LINE}" "{tmp_path}/before"', monkeypatch)
    bootloader = ("--bootloader", str(program.parent / BOOTLOADER))
    with monkeypatch.context() as plain:
        plain.delenv("LD_PRELOAD")
        arduino = EmulatorProcess(
            program, robot.with_suffix(".elf"), tmp_path / "tty", tmp_path / "socket", *bootloader
        )
    with arduino, arduino.connect() as board:
        monkeypatch.setenv("MUCAT_GPIO_BOARD", str(arduino.process.pid))
        resets = board.stats()["resets"]
        reset = f"gpio:{chip.path}:{LINE}"
        assert run_lab(b"", "--restore", str(robot), "--port", str(arduino.tty), "--reset", reset) == (0, [])
        assert board.stats()["resets"] > resets
    before = [row.split()[0] for row in (tmp_path / "before").read_text().splitlines()]
    # Where the computer is busy, an upload is begun again, from the reset on.
    assert before[-4:] == ["output", "low", "high", "released"]


def put_before_avrdude(folder: Path, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a shell command run before each start of avrdude."""
    real = shutil.which("avrdude")
    assert real is not None
    wrapper = folder / "avrdude"
    wrapper.write_text(f'#!/bin/sh\n{command}\nexec {real} "$@"\n')
    wrapper.chmod(0o700)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")


@contextmanager
def kernel_chip() -> Iterator[tuple[Path, Path]]:
    """A chip of gpio-sim: its device, and the file with the level of its line."""
    device = GPIO_SIM / f"mucat-{os.getpid()}"
    bank = device / "bank"
    bank.mkdir(parents=True)
    try:
        (bank / "num_lines").write_text("8")
        (device / "live").write_text("1")
        name = (bank / "chip_name").read_text().strip()
        line = Path("/sys/devices/platform") / (device / "dev_name").read_text().strip() / name
        (line / f"sim_gpio{LINE}" / "pull").write_text("pull-up")
        yield Path("/dev") / name, line / f"sim_gpio{LINE}" / "value"
    finally:
        (device / "live").write_text("0")
        bank.rmdir()
        device.rmdir()


@pytest.mark.skipif(
    not os.access(GPIO_SIM, os.W_OK), reason="the kernel has no gpio-sim here (`modprobe gpio-sim`, as root)"
)
def test_a_pin_of_the_kernel_goes_low_and_comes_back() -> None:
    with kernel_chip() as (path, value):
        seen, ending = [value.read_text().strip()], threading.Event()

        def watch() -> None:
            while not ending.is_set():
                seen.append(value.read_text().strip())

        watching = threading.Thread(target=watch)
        watching.start()
        try:
            find_reset(f"gpio:{path}:{LINE}")()
        finally:
            ending.set()
            watching.join()
        seen.append(value.read_text().strip())
    assert [level for level, _ in groupby(seen)] == ["1", "0", "1"]
