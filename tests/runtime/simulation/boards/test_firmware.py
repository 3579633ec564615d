"""The firmware for each baud: its own path, and its build where it is missing."""

import time
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


def test_two_builds_at_once_wait_for_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make = tmp_path / "make"
    make.write_text(f"#!/bin/sh\nmkdir {tmp_path}/busy && sleep 0.2 && rmdir {tmp_path}/busy\n")
    make.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    with ThreadPoolExecutor(2) as pool:
        for build in [pool.submit(build_firmware, tmp_path, 4800) for _ in range(2)]:
            build.result()


def test_a_build_for_another_speed_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The build for 4800 bit/s ends as soon as the one for 9600, begun after it, has ended."""
    make = tmp_path / "make"
    make.write_text(
        "#!/bin/sh\n"
        f"case $* in *BAUD=9600*) touch {tmp_path}/ended; exit; esac\n"
        f"touch {tmp_path}/begun\n"
        f"timeout 30 sh -c 'until [ -e {tmp_path}/ended ]; do sleep 0.02; done'\n"
    )
    make.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(build_firmware, tmp_path, 4800)
        while not (tmp_path / "begun").exists() and not first.done():
            time.sleep(0.02)
        build_firmware(tmp_path, 9600)
        first.result()


def test_a_compiler_error_is_reported(tmp_path: Path) -> None:
    with pytest.raises(FirmwareBuildError, match=r"could not be built: .*2\.5 % off"):
        build_firmware(tmp_path, 460_800)
