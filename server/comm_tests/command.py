"""`mucat commtest`: run, list, show, compare and export communication tests from a shell."""

import argparse
import os
import signal
import sqlite3
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from pathlib import Path

from migrations import HEAD
from robot_runtime.comm_test.builder import Builder, BuildError, hash_file
from robot_runtime.comm_test.document import CommTest, DocumentError, read_document
from robot_runtime.comm_test.results import CellResult
from robot_runtime.comm_test.runner import Runner, estimate_seconds
from robot_runtime.link.port import PortError
from robot_runtime.simulation.board import BoardError
from server.comm_tests import tables
from server.comm_tests.reference import TABLES, Place, read_table
from server.comm_tests.runs import Runs
from server.models import CommTestRun
from server.schema import prepare, read_revision
from server.settings import DataFolder, Settings, SetupError
from server.store import Store, StoreError

Claim = Callable[[DataFolder], AbstractContextManager[None]]


def perform(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Do what the command line says. Exit status: 1 where a run did not come to its end.

    Raises SetupError, with a line for a person, where it cannot be done.
    """
    try:
        if options.action == "run":
            return _run(options.file, settings, claim)
        with _open(settings.data, claim) as runs:
            print(_look(options, runs), end="")  # noqa: T201 - a command line speaks
    except StoreError as problem:
        raise SetupError(f"The database {settings.data.database} fails: {problem}") from problem
    return 0


def _look(options: argparse.Namespace, runs: Runs) -> str:
    if options.action == "list":
        return tables.show_list(runs.list()) + "\n"
    if options.action == "compare":
        return tables.show_comparison({name: _rates(runs, name) for name in options.runs}) + "\n"
    run, cells = _find(runs, options.run), runs.cells(options.run)
    if options.action == "show":
        return tables.show_run(run, cells) + "\n"
    return (tables.write_csv if options.format == "csv" else tables.write_json)(run, cells)


def _rates(runs: Runs, name: str) -> dict[Place, float]:
    if name in TABLES:
        return read_table(name)
    if not name.isdecimal():
        raise SetupError(f"{name!r} is neither the number of a run nor one of {', '.join(TABLES)}.")
    _find(runs, int(name))
    return tables.places(runs.cells(int(name)))


def _find(runs: Runs, number: int) -> CommTestRun:
    run = runs.find(number)
    if run is None:
        raise SetupError(f"There is no run {number}; `mucat commtest list` shows those that there are.")
    return run


@contextmanager
def _open(folder: DataFolder, claim: Claim) -> Iterator[Runs]:
    # Only reads, so it may be done beside a running server; making or upgrading a database may not.
    if not _is_current(folder):
        with claim(folder):
            prepare(folder)
    with closing(Store(folder.database)) as store:
        yield Runs(store)


def _is_current(folder: DataFolder) -> bool:
    try:
        return read_revision(folder.database) == HEAD
    except sqlite3.DatabaseError:
        return False  # `prepare` says what is the matter


def _run(file: Path, settings: Settings, claim: Claim) -> int:
    tests = _read(file)
    program = settings.build / "board"
    if not program.exists():
        raise SetupError(f"There is no emulated board at {program}; `make firmware` builds it.")
    try:
        builder = Builder(settings.build / "comm_test")
    except BuildError as problem:
        raise SetupError(str(problem)) from problem
    with claim(settings.data):
        prepare(settings.data)
        with closing(Store(settings.data.database)) as store, _interruptions() as interrupted:
            runs = Runs(store)
            runs.mark_interrupted()
            tools = {"compiler": builder.compiler, "emulated board": hash_file(program)}
            for test in tests:
                number = runs.start(test, builder.firmware_hash, tools)
                runner = Runner(builder, program, os.cpu_count() or 1)
                complete = _run_one(runs, number, test, runner, interrupted)
                print(f"\n{tables.show_cells(runs.cells(number))}")  # noqa: T201
                if not complete:
                    return 1
    return 0


def _read(file: Path) -> list[CommTest]:
    try:
        return read_document(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as problem:
        raise SetupError(f"{file} cannot be read: {problem}") from problem
    except DocumentError as problem:
        raise SetupError("\n  ".join([f"{file} cannot be run:", *problem.problems])) from problem


def _run_one(
    runs: Runs, number: int, test: CommTest, runner: Runner, interrupted: Callable[[], bool]
) -> bool:
    """Whether it came to its end."""
    progress = _Progress(test)
    progress.begin(number)
    try:
        for place, result in enumerate(runner.run(test)):
            runs.add(number, place, result)
            progress.tell(place, result)
            if interrupted():
                break
        else:
            runs.end(number, "complete")
            return True
    except (BuildError, BoardError, PortError) as problem:
        if not interrupted():
            runs.end(number, "failed", str(problem))
            print(f"mucat: run {number} failed: {problem}", file=sys.stderr)  # noqa: T201
            return False
    runs.end(number, "cancelled")
    print(f"mucat: run {number} was cancelled; what it has measured is kept", file=sys.stderr)  # noqa: T201
    return False


@contextmanager
def _interruptions() -> Iterator[Callable[[], bool]]:
    # The terminal interrupts the emulated board as well, so its end is no failure then.
    noticed: list[int] = []
    before = {
        number: signal.signal(number, lambda got, _: noticed.append(got))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield lambda: bool(noticed)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class _Progress:
    def __init__(self, test: CommTest) -> None:
        self._test = test
        self._weights = [estimate_seconds(test, cell) for cell in test.cells]
        self._started = time.monotonic()

    def begin(self, number: int) -> None:
        words = f"run {number}: {self._test.name}, framing {self._test.framing}, {self._test.direction}"
        print(f"{words}, {len(self._weights)} cells", flush=True)  # noqa: T201

    def tell(self, place: int, result: CellResult) -> None:
        elapsed = time.monotonic() - self._started
        done = sum(self._weights[: place + 1])
        remaining = elapsed * (sum(self._weights) - done) / done
        cell = result.cell
        where = f"{cell.baud:>6} baud, Arduino {cell.arduino_delay:g} s, Pi {cell.pi_delay:g} s"
        print(  # noqa: T201
            f"[{place + 1:>3}/{len(self._weights)}] {where:<42} {result.rate:.2f}  "
            f"{_clock(elapsed)} elapsed, {_clock(remaining)} remaining  {', '.join(result.causes)}".rstrip(),
            flush=True,
        )


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"
