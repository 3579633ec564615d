"""The wheels on a computer without repository, Node or compiler."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from packages.wheels import PYTHON_PACKAGES
from robot_runtime.places import PACKAGES
from robot_runtime.provenance import hash_firmware
from server import VERSION
from tests.documents.blocks import read_blocks
from tests.packages.installation import Installation
from tests.stack import Stack
from tests.waiting import SECONDS

MACHINE_OFFSET = 18
"""Bytes before the architecture in an ELF file's header (System V ABI, e_machine)."""
OTHER_MACHINE = b"\xf3\x00"
"""RISC-V, which no emulator of ours is for."""


def in_one_line(message: str) -> str:
    (line,) = message.splitlines()
    return line


def test_the_software_comes_from_the_wheels(installation: Installation, elsewhere: Path) -> None:
    done = installation.mucat("--version", cwd=elsewhere)
    assert done.stdout == f"mucat {VERSION}\n"
    packages = installation.packages
    for part in ("server/page/index.html", "server/help/index.html", "mucat_build/robot.toml"):
        assert (packages / part).exists(), part
    for speed in ("", "115200/"):
        for file in ("robot.hex", "bring_up.hex", "hil/robot.hex"):
            assert (packages / "mucat_build/firmware" / speed / file).read_text().startswith(":")
    assert (packages / "mucat_build/firmware/optiboot.hex").exists()


def test_every_file_of_the_packages_is_in_the_wheel(installation: Installation) -> None:
    listed = subprocess.run(
        ["git", "ls-files", *PYTHON_PACKAGES], cwd=PACKAGES, capture_output=True, text=True, check=True
    )
    missing = [file for file in listed.stdout.splitlines() if not (installation.packages / file).exists()]
    assert missing == []


def test_the_services_are_read_from_a_wheel_that_is_not_unpacked(mucat_wheel: Path) -> None:
    program = (
        f"import sys; sys.path.insert(0, {str(mucat_wheel)!r})\n"
        "from server.features.installation.places import InstallPlaces\n"
        "from server.features.installation.units import write_units\n"
        "print(__import__('server').__file__, *write_units(InstallPlaces()))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd="/", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    file, *names = done.stdout.split()
    assert file.startswith(str(mucat_wheel))
    assert {"mucat.service", "mucat-runtime.service"} <= set(names)


def test_a_scenario_swims_in_simulated_time(installation: Installation, elsewhere: Path) -> None:
    done = installation.mucat("scenario", "run", "figure_14", "--board", "host", cwd=elsewhere)
    assert done.returncode == 0, done.stderr
    assert (elsewhere / "data/mucat.db").exists()
    assert not (elsewhere / "data/robot.toml").exists()


class InstalledStack(Stack):
    def __init__(self, installation: Installation, folder: Path, *options: str) -> None:
        super().__init__(folder / "data", *options)
        self.program, self.folder, self.environment = installation.program, folder, installation.environment


@pytest.mark.stack
def test_it_swims_by_one_command_and_its_recording_names_the_firmware(
    installation: Installation, elsewhere: Path
) -> None:
    with InstalledStack(installation, elsewhere) as stack:
        stack.arm()
        end = time.monotonic() + SECONDS
        while not (sessions := stack.api.get("/sessions").json()):
            assert time.monotonic() < end, "arming began no session"
        assert "<html" in stack.api.get(stack.url).text
        assert stack.api.get(f"{stack.url}/help/").status_code == 200
        assert sessions[0]["firmware"] == hash_firmware(
            installation.packages / "mucat_build/firmware/robot.hex"
        )
    shown = (elsewhere / "data/robot.toml").read_text()
    assert shown == (installation.packages / "mucat_build/robot.toml").read_text()
    output = stack.log.read_text()
    assert f"Its configuration is {elsewhere}/data/robot.toml." in output


def test_a_configuration_in_the_data_folder_applies_and_stays(
    installation: Installation, elsewhere: Path
) -> None:
    own = '[robot]\nname = "UPPER"\n'
    (elsewhere / "data").mkdir()
    (elsewhere / "data/robot.toml").write_text(own)
    done = installation.mucat("run", cwd=elsewhere)
    assert "robot.name is 'UPPER'" in in_one_line(done.stderr)
    assert (elsewhere / "data/robot.toml").read_text() == own


def test_a_speed_without_packaged_firmware_is_refused(installation: Installation, elsewhere: Path) -> None:
    (elsewhere / "robot.toml").write_text("[link]\nbaud = 9600\n")
    done = installation.mucat("run", cwd=elsewhere)
    assert done.returncode == 1
    assert "250000 and 115200 baud" in in_one_line(done.stderr)


def test_a_missing_emulator_is_named(installation: Installation, elsewhere: Path) -> None:
    board = installation.packages / "mucat_build/board"
    away = board.rename(board.with_name("away"))
    try:
        done = installation.mucat("run", cwd=elsewhere)
    finally:
        away.rename(board)
    assert done.returncode == 1
    assert "pip install 'mucat[emulator]'" in in_one_line(done.stderr)


def test_an_emulator_of_another_architecture_is_refused(installation: Installation, elsewhere: Path) -> None:
    board = installation.packages / "mucat_build/board"
    away = Path(shutil.copy(board, board.with_name("away")))
    try:
        with board.open("r+b") as program:
            program.seek(MACHINE_OFFSET)
            program.write(OTHER_MACHINE)
        done = installation.mucat("run", cwd=elsewhere)
    finally:
        away.replace(board)
    assert done.returncode == 1
    assert "cannot run" in in_one_line(done.stderr)
    assert "Exec format error" in done.stderr


def test_the_commands_of_the_manual_install_the_wheels(installation: Installation, elsewhere: Path) -> None:
    (block,) = [block for block in read_blocks("run/packages.md") if block.title == "Any Linux"]
    *install, run = block.text.splitlines()
    assert run == "mucat/bin/mucat run"
    for file in installation.wheels:
        (elsewhere / file.name).symlink_to(file)
    shutil.copy(PACKAGES / "constraints.txt", elsewhere)
    alone = {**os.environ, "PIP_NO_INDEX": "1", "PIP_NO_DEPS": "1", "PYTHONPATH": ""}
    for line in install:
        done = subprocess.run(
            ["sh", "-c", line], cwd=elsewhere, env=alone, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    (packages,) = elsewhere.glob("mucat/lib/python*/site-packages")
    assert (packages / "mucat_build/board").stat().st_mode & 0o111
    assert (packages / "mucat_build/firmware/robot.hex").exists()
    assert (elsewhere / "mucat/bin/mucat").exists()
