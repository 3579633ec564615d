"""Runs a communication test from a shell, if no server uses the data folder."""

import asyncio
import signal
from collections.abc import Sequence
from typing import Any

from robot_runtime.clock import SteadyClock
from robot_runtime.experiments.comm_test.document import CommTest
from server.board_reservation import RobotBoard
from server.features.comm_tests import tables
from server.features.comm_tests.runner import CommTestRunner
from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.schemas import Place
from server.platform.models import CommTestRun
from server.platform.settings import Settings
from server.platform.shell_store import open_writer
from server.platform.terminal import echo


def run_tests(text: str, tests: list[CommTest], board: Place, settings: Settings) -> int:
    """Run the tests of a document in a claimed folder, and print the rates.

    Exit status: 1 if a run did not complete. Raise SetupError if it cannot start.
    """
    with open_writer(settings.data) as store:
        return asyncio.run(_perform(text, tests, board, settings, CommTestStore(store)))


async def _perform(
    text: str, tests: list[CommTest], board: Place, settings: Settings, runs: CommTestStore
) -> int:
    await runs.mark_interrupted()
    progress = _Progress(tests)
    robot_board = RobotBoard(settings, lambda _kind, _severity, text: echo(text, err=True))
    comm_tests = CommTestRunner(settings, runs, SteadyClock(), progress.notify, robot_board.reserve)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, comm_tests.cancel)
    first = await comm_tests.start(text, board)
    await comm_tests.wait()
    return _conclude([run for run in reversed(runs.list()) if (run.id or 0) >= first], len(tests), runs)


def _conclude(done: Sequence[CommTestRun], expected: int, runs: CommTestStore) -> int:
    for run in done:
        echo(f"\n{tables.show_cells(runs.cells(run.id or 0))}")
        if run.state == "cancelled":
            text = f"run {run.id} was cancelled; its finished cells are stored"
            echo(f"mucat: {text}", err=True)
        elif run.state != "complete":
            echo(f"mucat: run {run.id} failed: {run.problem}", err=True)
    return 0 if len(done) == expected and all(run.state == "complete" for run in done) else 1


class _Progress:
    """The printed progress of the tests."""

    def __init__(self, tests: list[CommTest]) -> None:
        self._tests = tests
        self._run: int | None = None

    def notify(self, message: dict[str, Any]) -> None:
        active, cell = message["active"], message["cell"]
        if active and active["run"] != self._run:
            self._run = active["run"]
            test = self._tests[active["test"]]
            text = f"run {self._run}: {test.name}, framing {test.framing}, {test.direction}"
            echo(f"{text}, {active['cells']} cells")
        if active and cell:
            where = f"{cell['baud']:>6} baud, Arduino {cell['arduino_delay']:g} s, Pi {cell['pi_delay']:g} s"
            times = f"{_clock(active['elapsed'])} elapsed"
            if active["remaining"] is not None:
                times += f", {_clock(active['remaining'])} remaining"
            causes = ", ".join(cell["causes"])
            line = (
                f"[{active['done']:>3}/{active['cells']}] {where:<42} {cell['rate']:.2f}  {times}  {causes}"
            )
            echo(line.rstrip())


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"
