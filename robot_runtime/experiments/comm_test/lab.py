"""Runs the tests of a document on emulated boards or on the robot's own, and reports each step."""

import json
import os
import platform
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from threading import Lock
from typing import Any, Protocol

from robot_runtime.experiments.comm_test.boot_loader import refuse_endless_resets
from robot_runtime.experiments.comm_test.builder import Builder, SketchBuildError, hash_file
from robot_runtime.experiments.comm_test.document import CommTest
from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.line import Cancellation, StoppedError, check
from robot_runtime.experiments.comm_test.port_line import PortLine
from robot_runtime.experiments.comm_test.reset_pin import Pull, ResetError
from robot_runtime.experiments.comm_test.results import CellResult
from robot_runtime.experiments.comm_test.runner import BOOTLOADER, Phase, Runner, run_cell
from robot_runtime.experiments.comm_test.upload import (
    BOOT_BAUD,
    UploadError,
    avrdude_version,
    read_out,
    upload,
)
from robot_runtime.link.link_driver import PortError
from robot_runtime.places import EMULATOR_REMEDY, FIRMWARE_REMEDY
from robot_runtime.simulation.boards.emulator_process import BoardError
from robot_runtime.transport.unbuffered_output import UnbufferedOutput

TEST_ERRORS = (SketchBuildError, UploadError, ResetError, BoardError, PortError)
"""Errors that end a test early; the texts say why."""

SKETCH_TIME, BOOT_LOADER_TIME = 0.2, 2.0
"""s until a sketch listens after its upload, and after a reset, when the boot loader listens first."""
ATTEMPTS = 3


class EventWriter:
    """Writer of events, one JSON object to a line, at once. May be used by several threads."""

    def __init__(self, output: UnbufferedOutput) -> None:
        self._output = output
        self._lock = Lock()

    def tell(self, event: str, **values: Any) -> None:
        """Write one event."""
        line = json.dumps({"event": event, **values}, ensure_ascii=False)
        with self._lock:
            self._output.write(line.encode() + b"\n")


class CommTestLab(Protocol):
    """The boards that tests run on. All methods raise the errors in TEST_ERRORS."""

    def prepare(self) -> tuple[str, dict[str, str], str]:
        """Return the hash of the sketch's sources, the tools' versions by name, and the boards as text."""

    def run(self, test: CommTest, tell: Callable[[int, Phase], None]) -> Iterator[CellResult]:
        """Return the cells of a test, in order. Raise StoppedError too."""


class EmulatedLab:
    """Boards of the lab's own, in emulated time, as many at once as there are cores."""

    def __init__(self, build: Path, stop: Cancellation) -> None:
        self._build = build
        self._stop = stop
        self._runner: Runner | None = None

    def prepare(self) -> tuple[str, dict[str, str], str]:
        """See CommTestLab."""
        program = self._build / "board"
        if not program.exists():
            raise BoardError(f"there is no emulated board at {program}; {EMULATOR_REMEDY}")
        bootloader = self._build / BOOTLOADER
        if not bootloader.exists():
            raise BoardError(f"there is no boot loader at {bootloader}; {FIRMWARE_REMEDY}")
        builder = Builder(self._build / "comm_test")
        self._runner = Runner(builder, program, os.cpu_count() or 1, self._stop)
        tools = {
            "compiler": builder.compiler,
            "avrdude": avrdude_version(),
            "boot loader": hash_file(bootloader),
            "emulated board": hash_file(program),
        }
        return builder.firmware_hash, tools, f"{_host()}, emulated board"

    def run(self, test: CommTest, tell: Callable[[int, Phase], None]) -> Iterator[CellResult]:
        """See CommTestLab."""
        assert self._runner
        return self._runner.run(test, tell)


class RobotLab:
    """The robot's own board at `port`, in real time, cell by cell.

    In the end the board holds the last sketch; `upload_to` brings the robot's firmware back.
    """

    def __init__(self, build: Path, port: str, pull: Pull, opening_resets: bool, stop: Cancellation) -> None:
        self._build = build
        self._port = port
        self._pull = pull
        self._boot_time = BOOT_LOADER_TIME if opening_resets else SKETCH_TIME
        self._stop = stop
        self._builder: Builder | None = None

    def prepare(self) -> tuple[str, dict[str, str], str]:
        """See CommTestLab."""
        self._builder = Builder(self._build / "comm_test")
        tools = {"compiler": self._builder.compiler, "avrdude": avrdude_version()}
        return self._builder.firmware_hash, tools, f"{_host()}, the robot's own board at {self._port}"

    def run(self, test: CommTest, tell: Callable[[int, Phase], None]) -> Iterator[CellResult]:
        """See CommTestLab."""
        assert self._builder
        for number, cell in enumerate(test.cells):
            check(self._stop)
            tell(number, "compile")
            product = self._builder.build(test, cell.baud, cell.arduino_delay)
            tell(number, "upload")
            upload_to(self._port, self._pull, product.hex, self._stop)
            tell(number, "run")
            with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
                proxy = Path(folder) if test.faults != Faults(seed=test.faults.seed) else None
                with PortLine(self._port, cell.baud, self._boot_time, self._stop, proxy) as line:
                    result = run_cell(test, cell, line)
            yield result


def upload_to(port: str, pull: Pull, program: Path, stop: Cancellation, progress: Path | None = None) -> None:
    """Upload to the board at a port, whose reset pin `pull` pulls. Raise the errors in TEST_ERRORS."""
    _try_with(port, pull, lambda: upload(program, port, BOOT_BAUD, stop, progress=progress))


def read_from(port: str, pull: Pull, program: Path, stop: Cancellation, progress: Path | None) -> None:
    """Read the firmware of the board at a port into a file. Raise the errors in TEST_ERRORS."""
    _try_with(port, pull, lambda: read_out(program, port, BOOT_BAUD, stop, progress))


def _try_with(port: str, pull: Pull, work: Callable[[], None]) -> None:
    # On a busy computer avrdude may take longer to its first word than the boot loader listens, 1 s.
    for remaining in reversed(range(ATTEMPTS)):
        refuse_endless_resets(port, pull)
        pull()
        try:
            work()
            return
        except UploadError as problem:
            if not remaining:
                raise
            print(f"{problem}; trying again", file=sys.stderr, flush=True)  # noqa: T201


def run_tests(tests: Sequence[CommTest], lab: CommTestLab, writer: EventWriter, stop: Cancellation) -> bool:
    """Run tests one after the other until one is not completed; return True if all were."""
    return all(_run_test(number, test, lab, writer, stop) for number, test in enumerate(tests))


def _run_test(number: int, test: CommTest, lab: CommTestLab, writer: EventWriter, stop: Cancellation) -> bool:
    state, problem = "complete", ""
    try:
        firmware, tools, host = lab.prepare()
        writer.tell("started", test=number, firmware=firmware, tools=tools, host=host)
        results = lab.run(
            test, lambda cell, phase: writer.tell("phase", test=number, number=cell, phase=phase)
        )
        for cell, result in enumerate(results):
            writer.tell("cell", test=number, number=cell, values=result.values)
    except StoppedError:
        state = "cancelled"
    except TEST_ERRORS as trouble:
        # A terminal interrupts the boards and tools of the lab as well, so their end is no failure then.
        state, problem = ("cancelled", "") if stop.is_set() else ("failed", str(trouble))
    writer.tell("ended", test=number, state=state, problem=problem)
    return state == "complete"


def _host() -> str:
    return f"{platform.node()} {platform.system()} {platform.machine()}"
