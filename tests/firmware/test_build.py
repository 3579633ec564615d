"""The firmware for the chip: it fits, leaves room for the stack, and has the layout of the Arduino IDE."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.board.rig import ROOT, build

FIRMWARE = ROOT / "firmware"
FLASH_BYTES = 28672
"""Of the Arduino Mini, by its boards.txt: the ATmega328P's, less the largest boot section."""
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


def test_the_robot_begins_as_zeros_that_flash_does_not_have(elf: Path) -> None:
    names = subprocess.run(["avr-nm", elf], check=True, capture_output=True, text=True).stdout
    assert re.search(r" B robot$", names, re.MULTILINE)
    assert "_GLOBAL__sub_I" not in names


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
        "url",
    } <= set(properties)
    assert (FIRMWARE / "src" / properties["includes"]).is_file()
    sketches = sorted((FIRMWARE / "examples").glob("*/*.ino"))
    assert sketches
    for sketch in sketches:
        assert sketch.stem == sketch.parent.name
    # The communication test uses the core's Serial, whose interrupts the library has itself.
    users = [sketch.stem for sketch in sketches if properties["includes"] in sketch.read_text("utf-8")]
    assert users == ["robot"]


def test_the_arduino_ide_s_own_builder_builds_the_sketch(tmp_path: Path) -> None:
    """Debian's arduino-builder is the compiler driver of Arduino IDE 1.8."""
    library, output = tmp_path / "libraries/mucat", tmp_path / "output"
    for name in ("src", "library.properties", "keywords.txt", "examples"):
        position, result = library / name, FIRMWARE / name
        if result.is_dir():
            shutil.copytree(result, position)
        else:
            shutil.copy(result, position)
    output.mkdir()
    preferences = {
        # What the IDE knows of its own, and Debian's core lacks.
        "tools.ctags.pattern": '"arduino-ctags" -u --language-force=c++ -f - --c++-kinds=svpf '
        '--fields=KSTtzns --line-directives "{source_file}"',
        "runtime.tools.avr-gcc.path": "/usr",
        "compiler.cpp.extra_flags": "-DDECIMAL_DIG=__DECIMAL_DIG__",
    }
    options = {
        "-hardware": "/usr/share/arduino/hardware",
        "-tools": "/usr/bin",
        "-libraries": library.parent,
        "-fqbn": "arduino:avr:mini:cpu=atmega328",
        "-build-path": output,
    }
    built = subprocess.run(
        [
            "arduino-builder",
            "-compile",
            *(str(argument) for option in options.items() for argument in option),
            *("-hardware", "/usr/share/arduino-builder"),
            *(argument for name, value in preferences.items() for argument in ("-prefs", f"{name}={value}")),
            str(library / "examples/robot/robot.ino"),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert "Invalid library" not in built.stderr
    assert (output / "robot.ino.hex").read_text().startswith(":")


def test_the_keywords_are_the_library_s_own() -> None:
    lines = (FIRMWARE / "keywords.txt").read_text().splitlines()
    header = (FIRMWARE / "src/robot.h").read_text()
    for line in lines:
        word, kind = line.split("\t")
        assert re.search(rf"class {word} " if kind == "KEYWORD1" else rf"\b{word}\(", header)


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
