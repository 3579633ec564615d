"""Runs communication tests, one document at a time, in a process of its own; keeps and passes on what it tells.

The process (`python -m robot_runtime.comm_test`) compiles, uploads and runs, and tells what it does in lines
of JSON. Here they become rows of the database and progress for the pages.
"""

import asyncio
import json
import logging
import sys
from collections import deque
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, suppress
from dataclasses import dataclass, field
from signal import SIGTERM
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.comm_test.document import CommTest, read_document
from robot_runtime.comm_test.runner import estimate_seconds
from robot_runtime.errors import Refused
from server.comm_tests.runs import End, Runs
from server.comm_tests.shapes import Cell, Phase, Place
from server.process import Process
from server.settings import Settings
from server.store import StoreError

log = logging.getLogger(__name__)

LINE_BYTES_MAX = 100_000
WORDS_KEPT = 5
"""Lines that are no JSON are the last words of a process that fails."""
CANCEL_SECONDS = 90.0
"""After which a cancelled process is killed; it may have to bring the robot's firmware back."""

Tell = Callable[[dict[str, Any]], None]
Lend = Callable[[str], AbstractAsyncContextManager[list[str]]]
"""Called with the test's name; while it is entered the robot's board is the lab's, and its value are the
lab's arguments for it. Raises Refused where the board cannot be had."""


@dataclass(slots=True)
class Progress:
    """What is being run; `weights` are the cells' test times in s, test by test."""

    tests: list[CommTest]
    place: Place
    began: float
    weights: list[list[float]]
    test: int = 0
    run: int | None = None
    done: int = 0
    done_weight: float = 0.0
    phases: dict[int, Phase] = field(default_factory=dict)

    def describe(self, now: float) -> dict[str, Any]:
        """As the pages are told; `remaining` is for all tests of the document, null while unknown."""
        elapsed = now - self.began
        left = sum(map(sum, self.weights)) - self.done_weight
        return {
            "run": self.run,
            "name": self.tests[self.test].name,
            "place": self.place,
            "test": self.test,
            "tests": len(self.tests),
            "cells": len(self.weights[self.test]),
            "done": self.done,
            "elapsed": elapsed,
            "remaining": elapsed * left / self.done_weight if self.done_weight else None,
            "phase": {str(number): phase for number, phase in self.phases.items()},
        }


class Lab:
    """At most one document runs at a time; `tell` hears of all progress, `lend` gives the board away."""

    def __init__(self, settings: Settings, runs: Runs, clock: Clock, tell: Tell, lend: Lend) -> None:
        self.runs = runs
        self._settings = settings
        self._clock = clock
        self._tell = tell
        self._lend = lend
        self._task: asyncio.Task[None] | None = None
        self._process: Process | None = None
        self._cancelled = False

    @property
    def busy(self) -> bool:
        """Whether a document is being run."""
        return self._task is not None and not self._task.done()

    async def start(self, text: str, place: Place) -> int:
        """Run a document; returns the number of its first run as soon as that has begun.

        Raises DocumentError, Refused where it cannot be run now, StoreError.
        """
        tests = read_document(text)
        if self.busy:
            raise Refused("A communication test is running. Wait for its end, or cancel it.")
        began: asyncio.Future[int] = asyncio.get_running_loop().create_future()
        self._cancelled = False
        self._task = asyncio.create_task(self._run(tests, text, place, began))
        return await asyncio.shield(began)

    async def wait(self) -> None:
        """Wait until nothing runs."""
        if self._task is not None:
            await asyncio.wait([self._task])

    async def cancel(self) -> None:
        """End what runs, in order; the cells that are finished are kept."""
        self._cancelled = True
        if self._process is not None:
            self._process.signal(SIGTERM)
        if self.busy:
            assert self._task is not None
            _, late = await asyncio.wait([self._task], timeout=CANCEL_SECONDS)
            if late and self._process is not None:
                self._process.close()
                await self.wait()

    async def _run(self, tests: list[CommTest], text: str, place: Place, began: asyncio.Future[int]) -> None:
        progress = Progress(
            tests,
            place,
            self._clock.now(),
            [[estimate_seconds(one, cell) for cell in one.cells] for one in tests],
        )
        try:
            if place == "robot":
                async with self._lend(tests[0].name) as arguments:
                    await self._perform(progress, text, arguments, began)
            else:
                await self._perform(progress, text, [], began)
        except (Refused, StoreError, OSError) as problem:
            log.warning("the communication test ended: %s", problem)
            if progress.run is not None:
                with suppress(StoreError):
                    await self.runs.end(progress.run, "failed", str(problem))
            if not began.done():
                began.set_exception(problem if not isinstance(problem, OSError) else Refused(str(problem)))
        finally:
            self._tell({"op": "comm_test", "active": None, "cell": None})
            if not began.done():
                began.set_exception(Refused("The communication test ended before it began."))

    async def _perform(
        self, progress: Progress, text: str, arguments: list[str], began: asyncio.Future[int]
    ) -> None:
        document = self._settings.data.run / "comm_test.json"
        await asyncio.to_thread(document.write_text, text, encoding="utf-8")
        lines: asyncio.Queue[bytes | None] = asyncio.Queue()
        output = _Lines(lines)
        command = [sys.executable, "-m", "robot_runtime.comm_test", "--document", str(document)]
        command += [
            "--build",
            str(self._settings.build),
            "--where",
            progress.place,
            "--with-parent",
            *arguments,
        ]
        self._process = Process(command, output.feed)
        if self._cancelled:
            self._process.signal(SIGTERM)
        waiting = asyncio.create_task(self._end_of(self._process, output))
        words: deque[str] = deque(maxlen=WORDS_KEPT)
        try:
            while (line := await lines.get()) is not None:
                await self._take(progress, line, words, began)
            status = await waiting
        finally:
            self._process.close()
            self._process = None
            waiting.cancel()
        if progress.run is not None:
            said = " / ".join(words) or f"exit status {status}"
            await self._end(progress, "cancelled" if self._cancelled else "failed", f"The lab ended: {said}")
        if not began.done():
            began.set_exception(Refused(f"The communication test could not begin: {' / '.join(words)}"))

    async def _end_of(self, process: Process, output: "_Lines") -> int:
        status = await process.wait()
        output.end()
        return status

    async def _take(
        self, progress: Progress, line: bytes, words: deque[str], began: asyncio.Future[int]
    ) -> None:
        event = _read_event(line)
        if event is None:
            words.append(line.decode(errors="replace").strip())
            log.info("comm_test: %s", words[-1])
            return
        cell: Cell | None = None
        match event.get("event"):
            case "started":
                progress.test = int(event["test"])
                progress.done, progress.phases = 0, {}
                test = progress.tests[progress.test]
                progress.run = await self.runs.start(
                    test, progress.place, str(event["firmware"]), event["tools"], str(event["host"])
                )
                if not began.done():
                    began.set_result(progress.run)
            case "phase":
                progress.phases[int(event["number"])] = event["phase"]
            case "cell" if progress.run is not None:
                number = int(event["number"])
                cell = await self.runs.add(progress.run, number, event["values"])
                progress.done += 1
                progress.done_weight += progress.weights[progress.test][number]
                progress.phases.pop(number, None)
            case "ended" if progress.run is not None:
                await self._end(progress, event["state"], str(event["problem"]))
            case "refused":
                words.extend(map(str, event["problems"]))
        active = progress.describe(self._clock.now()) if progress.run is not None else None
        shown = None if cell is None else {"run": progress.run, **cell.model_dump()}
        self._tell({"op": "comm_test", "active": active, "cell": shown})

    async def _end(self, progress: Progress, state: End, problem: str) -> None:
        assert progress.run is not None
        await self.runs.end(progress.run, state, problem)
        progress.run = None
        progress.done_weight = sum(sum(one) for one in progress.weights[: progress.test + 1])


class _Lines:
    """Cuts what a process prints into lines; None is the end."""

    def __init__(self, lines: asyncio.Queue[bytes | None]) -> None:
        self._lines = lines
        self._partial = b""

    def feed(self, data: bytes) -> None:
        *whole, self._partial = (self._partial + data).split(b"\n")
        self._partial = self._partial[-LINE_BYTES_MAX:]
        for line in whole:
            if line.strip():
                self._lines.put_nowait(line)

    def end(self) -> None:
        if self._partial.strip():
            self._lines.put_nowait(self._partial)
        self._lines.put_nowait(None)


def _read_event(line: bytes) -> dict[str, Any] | None:
    if not line.startswith(b"{"):
        return None
    try:
        event = json.loads(line)
    except ValueError:
        return None
    return event if isinstance(event, dict) else None
