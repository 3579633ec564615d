"""Uploads through the boot loader of a paused board by the real avrdude, at any speed of the host."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test import upload as module
from robot_runtime.experiments.comm_test.builder import Builder
from robot_runtime.experiments.comm_test.emulated_line import EmulatedLine
from robot_runtime.experiments.comm_test.line import Cancellation, StoppedError
from robot_runtime.experiments.comm_test.results import CellResult, GridCell
from robot_runtime.experiments.comm_test.runner import BOOTLOADER, run_cell
from robot_runtime.experiments.comm_test.upload import UploadError, avrdude_version, upload_paused
from robot_runtime.simulation.boards.emulator_process import EmulatorClient, EmulatorProcess
from tests.runtime.experiments.comm_test.conftest import make_test

pytestmark = pytest.mark.stack
"""avrdude waits by its own clock."""

TEST, CELL = make_test(framing="robot"), GridCell(115200, 0.0, 0.0)
Empty = tuple[EmulatorProcess, EmulatorClient]


@pytest.fixture
def empty(program: Path, tmp_path: Path) -> Iterator[Empty]:
    """A paused board with nothing but its boot loader."""
    options = ("--bootloader", str(program.parent / BOOTLOADER), "--paused")
    with (
        EmulatorProcess(program, None, tmp_path / "tty", tmp_path / "socket", *options) as process,
        process.connect() as board,
    ):
        yield process, board


def run_there(empty: Empty) -> CellResult:
    process, board = empty
    with EmulatedLine(board, process.tty, CELL.baud) as line:
        return run_cell(TEST, CELL, line)


def test_the_version_of_avrdude_is_read() -> None:
    assert avrdude_version().startswith("avrdude version ")


def test_a_second_upload_does_not_depend_on_the_first(builder: Builder, empty: Empty) -> None:
    process, board = empty
    product = builder.build(TEST, CELL.baud, 0.0)
    upload_paused(product.hex, process.tty, board, Cancellation())
    first = run_there(empty)
    assert first.rate == 1.0
    upload_paused(product.hex, process.tty, board, Cancellation())
    board.run(0.3)  # the sketch runs, and counts its start in the EEPROM
    upload_paused(product.hex, process.tty, board, Cancellation())
    again = run_there(empty)
    assert again == first


def test_the_boot_loader_waits_for_a_slow_host(
    builder: Builder, empty: Empty, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Much longer between two reads than between two of avrdude's commands.
    monkeypatch.setattr(module, "LOOK", 0.05)
    process, board = empty
    upload_paused(builder.build(TEST, CELL.baud, 0.0).hex, process.tty, board, Cancellation())
    assert board.stats()["time"] < 3.0
    assert run_there(empty).rate == 1.0


def replace_avrdude(script: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a shell script before the real avrdude."""
    avrdude = folder / "bin/avrdude"
    avrdude.parent.mkdir()
    avrdude.write_text(f"#!/bin/sh\n{script}")
    avrdude.chmod(0o755)
    monkeypatch.setenv("PATH", f"{avrdude.parent}:{os.environ['PATH']}")


def test_an_upload_that_loses_step_is_started_over(
    builder: Builder, empty: Empty, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    product = builder.build(TEST, CELL.baud, 0.0)
    lost = tmp_path / "lost"
    # The first one hangs up in the middle, as one that was starved; the next ones are whole.
    replace_avrdude(
        f'[ -e {lost} ] && exec {shutil.which("avrdude")} "$@"\n'
        f'touch {lost}\ntimeout 0.5 {shutil.which("avrdude")} "$@"\nexit 1\n',
        tmp_path,
        monkeypatch,
    )
    process, board = empty
    upload_paused(product.hex, process.tty, board, Cancellation())
    assert lost.exists()
    assert run_there(empty).rate == 1.0


def test_a_failing_upload_is_reported_after_some_attempts(
    builder: Builder, empty: Empty, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    product = builder.build(TEST, CELL.baud, 0.0)
    calls = tmp_path / "calls"
    replace_avrdude(f"echo again >> {calls}\necho out of step >&2\nexit 1\n", tmp_path, monkeypatch)
    process, board = empty
    with pytest.raises(UploadError, match=r"could not upload comm_test.hex through .*: out of step"):
        upload_paused(product.hex, process.tty, board, Cancellation())
    assert len(calls.read_text().splitlines()) == module.ATTEMPTS


def test_a_missing_boot_loader_is_reported_with_avrdude_s_text(
    builder: Builder, program: Path, tmp_path: Path
) -> None:
    product = builder.build(TEST, CELL.baud, 0.0)
    with (
        EmulatorProcess(program, product.elf, tmp_path / "tty", tmp_path / "socket", "--paused") as process,
        process.connect() as board,
        pytest.raises(
            UploadError, match=r"could not upload comm_test.hex through .*: .*not in sync"
        ) as report,
    ):
        upload_paused(product.hex, process.tty, board, Cancellation())
    assert "\n" not in str(report.value)


def test_an_upload_can_be_cancelled(builder: Builder, empty: Empty) -> None:
    process, board = empty
    stop = Cancellation()
    stop.set()
    with pytest.raises(StoppedError):
        upload_paused(builder.build(TEST, CELL.baud, 0.0).hex, process.tty, board, stop)


def test_without_avrdude_its_installation_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UploadError, match="install the package avrdude"):
        avrdude_version()
