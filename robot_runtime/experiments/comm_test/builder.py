"""Compiles the test's sketch for one baud and one Arduino delay, as firmware/Makefile compiles the robot's.

For the robot's framing the parts of its library that make up the link are compiled for that baud as well.

Products are kept in a folder named by the hash of everything that goes into them: sources, core, flags
and the compiler's version.
"""

import hashlib
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from robot_runtime.experiments.comm_test.document import SKETCH, CommTest
from robot_runtime.experiments.comm_test.framings import FRAMINGS
from robot_runtime.places import FIRMWARE_SOURCES

COMPILE_TIMEOUT = 60.0
"""s for one call of the compiler."""
HASH_CHARACTERS = 16
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
SKETCHES = FIRMWARE_SOURCES / "examples"
LIBRARY = FIRMWARE_SOURCES / "src"
LINK_PARTS = ("link", "board/avr")
"""The folders of the library that the sketch needs."""

MCU = ("-mmcu=atmega328p",)
COMMON = (
    *MCU,
    *("-DF_CPU=16000000L", "-DARDUINO=10819", "-DARDUINO_AVR_MINI", "-DARDUINO_ARCH_AVR"),
    *("-Os", "-g", "-flto", "-ffunction-sections", "-fdata-sections"),
    *(f"-I{ARDUINO}/cores/arduino", f"-I{ARDUINO}/variants/eightanaloginputs"),
)
CXX = (*COMMON, "-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics")
CORE = (*CXX, "-fpermissive", "-DDECIMAL_DIG=__DECIMAL_DIG__", "-w")
OWN = ("-Wall", "-Wextra", "-Werror")
QUEUE = "-DMUCAT_QUEUE_FRAMES=4"
"""The link's queue: a test fills the line, which the robot's few events do not."""
LINK = (*MCU, "-Os", "-g", "-flto", "-fuse-linker-plugin", "-Wl,--gc-sections")
DIRECTIONS = {"to_board": "COMM_TEST_TO_BOARD", "to_host": "COMM_TEST_TO_HOST", "both": "COMM_TEST_BOTH"}


class SketchBuildError(Exception):
    """The sketch could not be compiled; the text says why, with the compiler's own words."""


@dataclass(frozen=True, slots=True)
class Product:
    """A compiled sketch; `inputs` is the hash of everything it was made from."""

    elf: Path
    hex: Path
    inputs: str


def hash_file(path: Path) -> str:
    """Return the hash of a file's content, as short as those of products. Raise OSError."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:HASH_CHARACTERS]


class Builder:
    """Compiles into `folder`. Raises SketchBuildError where there is no compiler or no Arduino core."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.compiler = _run(["avr-g++", "--version"]).splitlines()[0]
        self._core_sources = sorted(
            path for path in (ARDUINO / "cores/arduino").glob("*") if path.suffix in (".c", ".cpp", ".S")
        )
        if not self._core_sources:
            raise SketchBuildError(
                f"the Arduino core is not in {ARDUINO}; install the package arduino-core-avr"
            )
        self._sketch = SKETCHES / SKETCH
        self._core_hash = self._hash(self._core_files(), CORE)
        library_files = [*_library_sources(), *sorted(LIBRARY.rglob("*.h"))]
        self._library_hash = self._hash(library_files, [*CXX, *OWN])
        texts = [self._core_hash, self._library_hash, *CXX, *OWN, *LINK]
        self.firmware_hash = self._hash(self._sketch_files(), texts)
        """Hash of all inputs but the parameters."""

    def build(self, test: CommTest, baud: int, arduino_delay: float) -> Product:
        """Return the sketch with these parameters, compiled now or before. Raise SketchBuildError."""
        parameters = _macros(test, baud, arduino_delay)
        inputs = self._hash([], [self.firmware_hash, *parameters])
        path = self._folder / inputs
        if not path.exists():
            library = baud if FRAMINGS[test.framing].library else None
            self._make(path, lambda unfinished: self._compile_sketch(unfinished, parameters, library))
        return Product(path / "comm_test.elf", path / "comm_test.hex", inputs)

    def _compile_sketch(self, folder: Path, parameters: Sequence[str], library: int | None) -> None:
        objects, elf = folder / "comm_test.o", folder / "comm_test.elf"
        include = (f"-I{LIBRARY}", "-x", "c++", "-include", "Arduino.h")
        _run(["avr-g++", *CXX, *OWN, *parameters, *include, "-c", str(self._sketch), "-o", str(objects)])
        archives = [self._library(library), self._core()] if library else [self._core()]
        _run(["avr-gcc", *LINK, str(objects), *map(str, archives), "-o", str(elf), "-lm"])
        _run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", str(elf), str(folder / "comm_test.hex")])
        objects.unlink()

    def _library(self, baud: int) -> Path:
        path = self._folder / f"library-{self._hash([], [self._library_hash, str(baud)])}"
        if not path.exists():
            self._make(path, lambda unfinished: self._compile_library(unfinished, baud))
        return path / "library.a"

    def _compile_library(self, folder: Path, baud: int) -> None:
        command = ["avr-g++", *CXX, *OWN, f"-I{LIBRARY}", f"-DMUCAT_BAUD={baud}", QUEUE]
        _archive(folder / "library.a", dict.fromkeys(_library_sources(), command))

    def _core(self) -> Path:
        path = self._folder / f"core-{self._core_hash}"
        if not path.exists():
            self._make(path, self._compile_core)
        return path / "core.a"

    def _compile_core(self, folder: Path) -> None:
        commands = {
            ".c": ["avr-gcc", *COMMON, "-std=gnu11", "-w"],
            ".cpp": ["avr-g++", *CORE],
            ".S": ["avr-gcc", *COMMON, "-x", "assembler-with-cpp"],
        }
        _archive(folder / "core.a", {source: commands[source.suffix] for source in self._core_sources})

    def _make(self, path: Path, compile_into: Callable[[Path], None]) -> None:
        # Under another name until it is whole, so that nobody finds half of it.
        self._folder.mkdir(parents=True, exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(prefix="unfinished-", dir=self._folder))
        try:
            compile_into(unfinished)
            unfinished.replace(path)
        except OSError as problem:
            if not path.exists():
                raise SketchBuildError(f"{path} cannot be written: {problem.strerror}") from problem
        finally:
            shutil.rmtree(unfinished, ignore_errors=True)

    def _core_files(self) -> list[Path]:
        folders = (ARDUINO / "cores/arduino", ARDUINO / "variants/eightanaloginputs")
        return sorted(path for folder in folders for path in folder.glob("*") if path.is_file())

    def _sketch_files(self) -> list[Path]:
        return sorted(path for path in self._sketch.parent.iterdir() if path.is_file())

    def _hash(self, files: Iterable[Path], texts: Iterable[str]) -> str:
        made = hashlib.sha256(self.compiler.encode())
        for word in texts:
            made.update(b"\0" + word.encode())
        for path in files:
            content = path.read_bytes()
            made.update(f"\0{path.name}\0{len(content)}\0".encode() + content)
        return made.hexdigest()[:HASH_CHARACTERS]


def _library_sources() -> list[Path]:
    return sorted(path for part in LINK_PARTS for path in (LIBRARY / part).glob("*.cpp"))


def _archive(archive: Path, commands: Mapping[Path, Sequence[str]]) -> None:
    """Compile each source by its command, and put the object files into an archive."""
    objects = []
    for source, command in commands.items():
        made = archive.parent / f"{source.name}.o"
        _run([*command, "-c", str(source), "-o", str(made)])
        objects.append(str(made))
    _run(["avr-gcc-ar", "rcs", str(archive), *objects])


def _macros(test: CommTest, baud: int, arduino_delay: float) -> list[str]:
    framing = FRAMINGS[test.framing]
    return [
        *([f"-DMUCAT_BAUD={baud}", QUEUE] if framing.library else []),
        f"-DCOMM_TEST_BAUD={baud}",
        f"-DCOMM_TEST_ARDUINO_DELAY={arduino_delay:.6f}",
        f"-DCOMM_TEST_FRAMING={framing.code}",
        f"-DCOMM_TEST_DIRECTION={DIRECTIONS[test.direction]}",
        f"-DCOMM_TEST_FROM={test.from_val}u",
        f"-DCOMM_TEST_TO={test.to_val}u",
    ]


def _run(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=COMPILE_TIMEOUT, check=False)
    except FileNotFoundError as problem:
        raise SketchBuildError(f"there is no {command[0]}; install the package gcc-avr") from problem
    except subprocess.TimeoutExpired as problem:
        raise SketchBuildError(f"{command[0]} did not end within {COMPILE_TIMEOUT:g} s") from problem
    if done.returncode:
        raise SketchBuildError(f"{command[0]} refused the sketch:\n{done.stderr.strip()}")
    return done.stdout
