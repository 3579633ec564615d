"""The firmware for each baud: its own path, and its build where it is missing."""

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from robot_runtime.simulation.boards.firmware import FirmwareBuildError, build_firmware, firmware_path

BUILD = Path(__file__).resolve().parents[4] / "build"


def test_each_speed_has_a_place_of_its_own() -> None:
    assert firmware_path(BUILD, 250_000, ".hex") == BUILD / "firmware/robot.hex"
    assert firmware_path(BUILD, 9600, ".elf") == BUILD / "firmware/9600/robot.elf"


def test_another_speed_is_built_beside_the_default() -> None:
    build_firmware(BUILD, 250_000)
    default = firmware_path(BUILD, 250_000, ".elf")
    before = default.read_bytes()
    build_firmware(BUILD, 9600)
    assert firmware_path(BUILD, 9600, ".hex").read_text().startswith(":")
    assert firmware_path(BUILD, 9600, ".elf").read_bytes() != before
    assert default.read_bytes() == before


def test_without_a_compiler_an_existing_build_is_used_or_the_remedy_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FirmwareBuildError, match=r"no firmware for 4800 baud .*Install make, gcc-avr"):
        build_firmware(tmp_path, 4800)
    product = firmware_path(tmp_path, 4800, ".elf")
    product.parent.mkdir(parents=True)
    product.touch()
    build_firmware(tmp_path, 4800)


@pytest.fixture
def place_make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Places a `make` of these words of the shell before the computer's own."""

    def write(message: str) -> None:
        make = tmp_path / "make"
        make.write_text(f"#!/bin/sh\n{message}\n")
        make.chmod(0o755)
        monkeypatch.setenv("PATH", str(tmp_path), prepend=":")

    return write


def test_two_builds_at_once_wait_for_each_other(tmp_path: Path, place_make: Callable[[str], None]) -> None:
    busy = tmp_path / "busy"
    place_make(f"case $* in *--question*) exit 1; esac\nmkdir {busy} && sleep 0.2 && rmdir {busy}")
    with ThreadPoolExecutor(2) as pool:
        for build in [pool.submit(build_firmware, tmp_path, 4800) for _ in range(2)]:
            build.result()


@pytest.mark.parametrize(("second", "is_current"), [(4800, "test -e"), (9600, "false")])
def test_a_build_is_not_waited_for_where_nothing_is_to_be_built_or_elsewhere(
    tmp_path: Path, place_make: Callable[[str], None], second: int, is_current: str
) -> None:
    """The first build ends as soon as the second one, which is begun after it, has ended."""
    begun, ended = tmp_path / "begun", tmp_path / "ended"
    place_make(
        f"case $* in *--question*) {is_current} {begun}; exit; esac\n"
        "case $* in *BAUD=9600*) exit; esac\n"
        f"touch {begun}; timeout 30 sh -c 'until test -e {ended}; do sleep 0.02; done'"
    )
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(build_firmware, tmp_path, 4800)
        while not begun.exists() and not first.done():
            time.sleep(0.02)
        build_firmware(tmp_path, second)
        ended.touch()
        first.result()


def test_a_compiler_error_is_reported(tmp_path: Path) -> None:
    with pytest.raises(FirmwareBuildError, match=r"could not be built: .*2\.5 % off"):
        build_firmware(tmp_path, 460_800)
