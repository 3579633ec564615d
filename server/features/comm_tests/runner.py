"""The runner of communication tests, one document at a time, in a process of its own.

The process (`python -m robot_runtime.experiments.comm_test`) compiles, uploads and runs, and reports in lines
of JSON, which become rows of the database and progress for the pages.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, suppress
from dataclasses import dataclass, field
from signal import SIGKILL, SIGTERM
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.comm_test.document import CommTest, read_document
from robot_runtime.experiments.comm_test.runner import estimate_seconds
from server.features.comm_tests.runs import CommTestStore, End
from server.features.comm_tests.schemas import Cell, Phase, Place
from server.platform.runs import RunOverError
from server.platform.settings import Settings
from server.platform.store import StoreError
from server.processes.side_process import SideProcess

log = logging.getLogger(__name__)

TEST_SECONDS_MAX = 86_400.0
"""s of the tests' own time, all cells together, so that a reserved board is free again within a day."""
CANCEL_SECONDS = 45.0
"""Time after which a cancelled process is killed; it may wait for an upload or a compiler."""


class CommTestError(Exception):
    """The test cannot continue; the text says why."""


Notify = Callable[[dict[str, Any]], None]
Reserve = Callable[[str], AbstractAsyncContextManager[list[str]]]
"""Called with the test in words; the context reserves the robot's board, its value are the arguments of the
test process. Raises RefusedError if the board is not free."""


@dataclass(slots=True)
class Progress:
    """Progress of the document that runs; `weights` are the cells' test times in s, test by test."""

    tests: list[CommTest]
    place: Place
    began: float
    weights: list[list[float]]
    test: int = 0
    run: int | None = None
    done: int = 0
    done_weight: float = 0.0
    first: tuple[float, float] | None = None
    """The end of the first cell (s), and its weight; the time before it, of a compiler, tells nothing."""
    phases: dict[int, Phase] = field(default_factory=dict)

    def describe(self, now: float) -> dict[str, Any]:
        """Return the progress for the pages; `remaining` is for the whole document, null while unknown."""
        remaining = sum(map(sum, self.weights)) - self.done_weight
        return {
            "run": self.run,
            "name": self.tests[self.test].name,
            "place": self.place,
            "test": self.test,
            "tests": len(self.tests),
            "cells": len(self.weights[self.test]),
            "done": self.done,
            "elapsed": now - self.began,
            "remaining": self._seconds_for(remaining, now),
            "phase": {str(number): phase for number, phase in self.phases.items()},
        }

    def count(self, number: int, now: float) -> None:
        """Count a cell of the running test as done."""
        weight = self.weights[self.test][number]
        self.first = self.first or (now, weight)
        self.done += 1
        self.done_weight += weight

    def _seconds_for(self, weight: float, now: float) -> float | None:
        if self.first is None:
            return None
        began, first = self.first
        done = self.done_weight - first
        if done <= 0:
            return None if weight > 0 else 0.0
        return (now - began) * weight / done


class CommTestRunner:
    """Runner of one document at a time; `notify` reports progress, `reserve` reserves the board.

    `ended` is called with number, name, end and problem of each test.
    """

    def __init__(
        self,
        settings: Settings,
        runs: CommTestStore,
        clock: Clock,
        notify: Notify,
        reserve: Reserve,
        ended: Callable[[int, str, End, str], None] = lambda *_: None,
    ) -> None:
        self._ended = ended
        self.runs = runs
        self._settings = settings
        self._clock = clock
        self._notify = notify
        self._reserve = reserve
        self._task: asyncio.Task[None] | None = None
        self._process: SideProcess | None = None
        self._cancelled = False
        self._begun: set[int] = set()
        """The runs of the newest document so far."""

    @property
    def busy(self) -> bool:
        """True while a document runs."""
        return self._task is not None and not self._task.done()

    async def start(self, text: str, board: Place) -> int:
        """Run a document; return the number of its first run as soon as that has begun.

        Raise ConfigError, RefusedError if it cannot be run now, StoreError.
        """
        tests = read_limited(text)
        if self.busy:
            raise RefusedError("A communication test is running. Wait for its end, or cancel it.")
        began: asyncio.Future[int] = asyncio.get_running_loop().create_future()
        self._cancelled = False
        self._begun = set()
        self._task = asyncio.create_task(self._run(tests, text, board, began))
        return await asyncio.shield(began)

    async def wait(self) -> None:
        """Wait until nothing runs."""
        if self._task is not None:
            await asyncio.wait([self._task])

    def cancel(self, run: int | None = None) -> None:
        """End the running document soon and in order; finished cells are stored.

        Raise RunOverError if this run is none of the document that runs.
        """
        if run is not None and not (self.busy and run in self._begun):
            raise RunOverError("communication test")
        self._cancelled = True
        process = self._process
        if process is not None:
            process.signal(SIGTERM)
            asyncio.get_running_loop().call_later(CANCEL_SECONDS, process.signal, SIGKILL)

    async def close(self) -> None:
        """Cancel what runs, and wait for its end."""
        self.cancel()
        await self.wait()

    async def _run(self, tests: list[CommTest], text: str, board: Place, began: asyncio.Future[int]) -> None:
        weights = [[estimate_seconds(test, cell) for cell in test.cells] for test in tests]
        progress = Progress(tests, board, self._clock.now(), weights)
        try:
            if board == "robot":
                async with self._reserve(f"The communication test “{tests[0].name}”") as arguments:
                    await self._perform(progress, text, arguments, began)
            else:
                await self._perform(progress, text, [], began)
        except (RefusedError, StoreError, CommTestError, OSError) as problem:
            log.warning("the communication test ended: %s", problem)
            if progress.run is not None:
                # If that cannot be stored, the next start marks it as interrupted.
                with suppress(StoreError):
                    await self.runs.end(progress.run, "failed", str(problem))
                self._ended(progress.run, tests[progress.test].name, "failed", str(problem))
            if not began.done():
                error = (
                    problem if isinstance(problem, RefusedError | StoreError) else RefusedError(str(problem))
                )
                began.set_exception(error)
        finally:
            self._notify({"op": "comm_test", "active": None, "cell": None})
            if not began.done():
                began.set_exception(RefusedError("The communication test ended before its first run."))

    async def _perform(
        self, progress: Progress, text: str, board: list[str], began: asyncio.Future[int]
    ) -> None:
        arguments = ["--build", str(self._settings.build), "--where", progress.place, "--with-parent"]
        if self._cancelled:
            raise RefusedError("The communication test was cancelled before its first run.")
        with SideProcess(
            "robot_runtime.experiments.comm_test", [*arguments, *board], text.encode()
        ) as process:
            self._process = process
            try:
                async for event in process.documents():
                    await self._take(progress, event, process.last_lines, began)
                end = await process.describe_end()
            finally:
                self._process = None
        if progress.run is not None:
            state: End = "cancelled" if self._cancelled else "failed"
            await self._end(progress, state, f"It broke off: it {end}")
        elif not began.done():
            why = "It was cancelled." if self._cancelled else " / ".join(process.last_lines) or f"It {end}"
            raise CommTestError(f"The communication test could not begin. {why}")

    async def _take(
        self, progress: Progress, event: dict[str, Any], last_lines: deque[str], began: asyncio.Future[int]
    ) -> None:
        try:
            cell = await self._apply(progress, event, last_lines, began)
        except (LookupError, TypeError, ValueError) as problem:
            raise CommTestError(
                f"The test process sent a message that is not valid: {problem!r}"
            ) from problem
        active = progress.describe(self._clock.now()) if progress.run is not None else None
        shown = None if cell is None else {"run": progress.run, **cell.model_dump()}
        self._notify({"op": "comm_test", "active": active, "cell": shown})

    async def _apply(
        self, progress: Progress, event: dict[str, Any], last_lines: deque[str], began: asyncio.Future[int]
    ) -> Cell | None:
        """Process an event of the test process; return a finished cell."""
        match event.get("event"):
            case "started":
                progress.test = int(event["test"])
                progress.done, progress.phases = 0, {}
                test, board, host = progress.tests[progress.test], progress.place, str(event["host"])
                progress.run = await self.runs.start(
                    test, board, str(event["firmware"]), event["tools"], host
                )
                self._begun.add(progress.run)
                if not began.done():
                    began.set_result(progress.run)
            case "phase":
                progress.phases[int(event["number"])] = event["phase"]
            case "cell" if progress.run is not None:
                number = int(event["number"])
                cell = await self.runs.add(progress.run, number, event["values"])
                progress.count(number, self._clock.now())
                progress.phases.pop(number, None)
                return cell
            case "ended" if progress.run is not None:
                await self._end(progress, event["state"], str(event["problem"]))
            case "refused":
                last_lines.extend(map(str, event["problems"]))
        return None

    async def _end(self, progress: Progress, state: End, problem: str) -> None:
        assert progress.run is not None
        await self.runs.end(progress.run, state, problem)
        self._ended(progress.run, progress.tests[progress.test].name, state, problem)
        progress.run = None
        progress.done_weight = sum(sum(cells) for cells in progress.weights[: progress.test + 1])


def read_limited(text: str) -> list[CommTest]:
    """Return the tests of a document within this server's limits. Raise ConfigError."""
    tests = read_document(text)
    seconds = sum(estimate_seconds(test, cell) for test in tests for cell in test.cells)
    if seconds > TEST_SECONDS_MAX:
        raise ConfigError(
            f"the document's cells take about {seconds / 3600:.0f} hours; at most "
            f"{TEST_SECONDS_MAX / 3600:g} can be run at once. Take fewer numbers, or shorter delays"
        )
    return tests
