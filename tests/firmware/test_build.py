"""The firmware for the chip: it fits, leaves room for the stack, and has the layout of the Arduino IDE."""

import re
import subprocess
from pathlib import Path

import pytest

from tests.board.rig import ROOT, build

FIRMWARE = ROOT / "firmware"
FLASH_BYTES = 30720
"""Of the ATmega328P, less a bootloader of 2 kB."""
RAM_BYTES = 2048
STACK_BYTES = 500


@pytest.fixture(scope="module")
def elf() -> Path:
    build(FIRMWARE, "robot", "hang")
    return ROOT / "build/firmware/robot.elf"


def test_it_fits_and_leaves_the_stack_its_room(elf: Path) -> None:
    sizes = subprocess.run(["avr-size", elf], check=True, capture_output=True, text=True).stdout
    text, data, bss = map(int, sizes.splitlines()[1].split()[:3])
    assert text + data <= FLASH_BYTES
    assert data + bss <= RAM_BYTES - STACK_BYTES


def test_neither_heap_nor_the_cores_serial_is_linked(elf: Path) -> None:
    names = subprocess.run(["avr-nm", "-C", elf], check=True, capture_output=True, text=True).stdout
    assert "mucat::" in names
    assert not re.search(r"\b(malloc|free|HardwareSerial|operator new|vfprintf)\b", names)


def test_hex_is_written(elf: Path) -> None:
    assert elf.with_suffix(".hex").read_text().startswith(":")


def test_library_is_one_for_the_arduino_ide() -> None:
    properties = dict(
        line.split("=", 1) for line in (FIRMWARE / "library.properties").read_text("utf-8").splitlines()
    )
    assert {
        "name",
        "version",
        "author",
        "maintainer",
        "sentence",
        "paragraph",
        "category",
        "architectures",
    } <= set(properties)
    assert (FIRMWARE / "src" / properties["includes"]).is_file()
    sketches = sorted((FIRMWARE / "examples").glob("*/*.ino"))
    assert sketches
    for sketch in sketches:
        assert sketch.stem == sketch.parent.name
    # The communication test uses the core's Serial, whose interrupts the library has itself.
    users = [sketch.stem for sketch in sketches if properties["includes"] in sketch.read_text("utf-8")]
    assert users == ["robot"]


@pytest.mark.parametrize("baud", [1200, 9600, 57600, 115200, 250000, 500000])
def test_every_usual_baud_compiles(baud: int, tmp_path: Path) -> None:
    """The error of the baud and the divider of telemetry are checked at compile time."""
    compile_line(baud, tmp_path)


def test_baud_that_the_chip_cannot_keep_is_refused(tmp_path: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError) as error:
        compile_line(460800, tmp_path)
    assert "this baud is more than 2.5 % off" in error.value.stderr


def compile_line(baud: int, folder: Path) -> None:
    for source in ("board/avr/line.cpp", "robot.cpp"):
        command = [
            "avr-g++",
            "-mmcu=atmega328p",
            "-DF_CPU=16000000L",
            "-std=gnu++11",
            "-Os",
            "-Wall",
            "-Wextra",
            "-Werror",
            f"-DMUCAT_BAUD={baud}",
            f"-I{FIRMWARE / 'src'}",
            "-c",
            str(FIRMWARE / "src" / source),
            "-o",
            str(folder / "line.o"),
        ]
        subprocess.run(command, check=True, capture_output=True, text=True)
