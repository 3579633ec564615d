"""`mucat commtest`: run, list, show, compare and export communication tests from a shell."""

import argparse
import asyncio
import signal
import sys
from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

from robot_runtime.clock import SteadyClock
from robot_runtime.errors import Refused
from robot_runtime.experiments.comm_test.document import CommTest, DocumentError, read_document
from server.features.comm_tests import tables
from server.features.comm_tests.board_reservation import Board
from server.features.comm_tests.lab import Lab
from server.features.comm_tests.reference import TABLES, read_table
from server.features.comm_tests.reference import Place as Cell
from server.features.comm_tests.runs import KeptRuns, Runs
from server.features.comm_tests.schemas import Place
from server.platform.models import CommTestRun
from server.platform.pidfile import end_parts
from server.platform.running_server import Claim, open_reader
from server.platform.schema import prepare
from server.platform.settings import Settings, SetupError
from server.platform.store import Store, StoreError


def perform(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Do what the command line says. Exit status: 1 where a run did not come to its end.

    Raises SetupError, with a line for a person, where it cannot be done.
    """
    try:
        if options.action == "run":
            return _run(
                options.file,
                options.place or ("emulated" if settings.emulated_board else "robot"),
                settings,
                claim,
            )
        with open_reader(settings.data, claim) as store:
            print(_look(options, KeptRuns(store)), end="")  # noqa: T201 - a command line speaks
    except StoreError as problem:
        raise SetupError(f"The database {settings.data.database} fails: {problem}") from problem
    return 0


def _look(options: argparse.Namespace, runs: KeptRuns) -> str:
    if options.action == "list":
        return tables.show_list(runs.list()) + "\n"
    if options.action == "compare":
        return tables.show_comparison({name: _rates(runs, name) for name in options.runs}) + "\n"
    run, cells = _find(runs, options.run), runs.cells(options.run)
    if options.action == "show":
        return tables.show_run(run, cells) + "\n"
    return (tables.write_csv if options.format == "csv" else tables.write_json)(run, cells)


def _rates(runs: KeptRuns, name: str) -> dict[Cell, float]:
    if name in TABLES:
        return read_table(name)
    if not name.isdecimal():
        raise SetupError(f"{name!r} is neither the number of a run nor one of {', '.join(TABLES)}.")
    _find(runs, int(name))
    return tables.places(runs.cells(int(name)))


def _find(runs: KeptRuns, number: int) -> CommTestRun:
    run = runs.find(number)
    if run is None:
        raise SetupError(f"There is no run {number}; `mucat commtest list` shows those that there are.")
    return run


def _run(file: Path, place: Place, settings: Settings, claim: Claim) -> int:
    text, tests = _read(file)
    if place == "robot" and settings.emulated_board:
        raise SetupError(
            "The emulated robot's board runs only while the server does. Start the test from the page, or "
            "leave --place out."
        )
    with ExitStack() as claimed:
        try:
            claimed.enter_context(claim(settings.data))
        except SetupError as problem:
            raise SetupError(f"{problem} Beside a running server, start the test from its page.") from problem
        end_parts(settings.data.run)
        prepare(settings.data)
        with closing(Store(settings.data.database)) as store:
            return asyncio.run(_perform(text, tests, place, settings, Runs(store)))


def _read(file: Path) -> tuple[str, list[CommTest]]:
    try:
        text = file.read_text(encoding="utf-8")
        return text, read_document(text)
    except (OSError, UnicodeDecodeError) as problem:
        raise SetupError(f"{file} cannot be read: {problem}") from problem
    except DocumentError as problem:
        raise SetupError("\n  ".join([f"{file} cannot be run:", *problem.problems])) from problem


async def _perform(text: str, tests: list[CommTest], place: Place, settings: Settings, runs: Runs) -> int:
    await runs.mark_interrupted()
    progress = _Progress(tests)
    board = Board(settings, lambda _kind, _severity, words: print(words, file=sys.stderr))  # noqa: T201
    lab = Lab(settings, runs, SteadyClock(), progress.tell, board.lend)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, lab.cancel)
    try:
        first = await lab.start(text, place)
    except Refused as problem:
        raise SetupError(str(problem)) from problem
    await lab.wait()
    return _conclude([run for run in reversed(runs.list()) if (run.id or 0) >= first], len(tests), runs)


def _conclude(done: Sequence[CommTestRun], wanted: int, runs: Runs) -> int:
    for run in done:
        print(f"\n{tables.show_cells(runs.cells(run.id or 0))}")  # noqa: T201 - a command line speaks
        if run.state == "cancelled":
            words = f"run {run.id} was cancelled; what it has measured is kept"
            print(f"mucat: {words}", file=sys.stderr)  # noqa: T201
        elif run.state != "complete":
            print(f"mucat: run {run.id} failed: {run.problem}", file=sys.stderr)  # noqa: T201
    return 0 if len(done) == wanted and all(run.state == "complete" for run in done) else 1


class _Progress:
    """Writes what the lab tells."""

    def __init__(self, tests: list[CommTest]) -> None:
        self._tests = tests
        self._run: int | None = None

    def tell(self, message: dict[str, Any]) -> None:
        active, cell = message["active"], message["cell"]
        if active and active["run"] != self._run:
            self._run = active["run"]
            test = self._tests[active["test"]]
            words = f"run {self._run}: {test.name}, framing {test.framing}, {test.direction}"
            print(f"{words}, {active['cells']} cells", flush=True)  # noqa: T201
        if active and cell:
            where = f"{cell['baud']:>6} baud, Arduino {cell['arduino_delay']:g} s, Pi {cell['pi_delay']:g} s"
            times = f"{_clock(active['elapsed'])} elapsed, {_clock(active['remaining'] or 0)} remaining"
            causes = ", ".join(cell["causes"])
            line = (
                f"[{active['done']:>3}/{active['cells']}] {where:<42} {cell['rate']:.2f}  {times}  {causes}"
            )
            print(line.rstrip(), flush=True)  # noqa: T201


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"
