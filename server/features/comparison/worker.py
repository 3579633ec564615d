"""The process `python -m server.features.comparison`: a comparison would block the server for seconds."""

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import Literal

from robot_runtime.transport.lifetime import memory_bytes
from server.platform.errors import UnavailableError
from server.platform.settings import DataFolder
from server.processes.task_process import TaskProcess, TaskProcessEndedError

Task = Literal[
    "compare",
    "lines",
    "signals",
    "report",
    "story",
    "track",
    "story_figures",
    "spectrum",
    "pair",
    "summary",
    "figures",
]

SECONDS_MAX = 120.0
REPORT_SECONDS_MAX = 600.0
"""Time that an answer may take: three hours of recording take 2 s on a desktop computer."""
IDLE_SECONDS = 300.0
"""Time after which the process ends that nobody asks anything: its caches take memory."""


ROOMY_BYTES = 2_000_000_000
"""Memory of a computer on which the process is there before anybody asks, and stays: it starts for 0.7 s, and
takes 80 MB."""


class ComparisonError(UnavailableError):
    """The sessions cannot be compared"""

    def __init__(self, problem: str, status: int = UnavailableError.status) -> None:
        super().__init__(problem)
        self.status = status


class ComparisonWorker:
    """A server's process for comparisons: started when needed, and left running for its caches.

    It answers one task after the other. A report has a process of its own, so that no task waits for it.
    """

    def __init__(self, folder: DataFolder) -> None:
        self._database = folder.database_location
        self._turn = asyncio.Lock()
        self._process: TaskProcess | None = None
        self._idle: asyncio.TimerHandle | None = None
        self._preparing: asyncio.Task[None] | None = None
        self._leaving: asyncio.Task[None] | None = None

    def prepare(self) -> None:
        """Start the process now, to stay, where the computer has enough memory."""
        if memory_bytes() >= ROOMY_BYTES:
            self._preparing = asyncio.create_task(self._prepare())

    async def _prepare(self) -> None:
        async with self._turn:
            if self._process is None:
                # Whoever asks for a comparison is told why there is none.
                with suppress(ComparisonError):
                    self._process = await _start(self._database)

    async def ask(self, task: Task, query: str) -> bytes:
        """Return the answer to a query, both as JSON. Raise ComparisonError."""
        async with self._turn:
            if self._idle is not None:
                self._idle.cancel()
            if self._process is None or self._process.ended:
                self._process = await _start(self._database)
            answer = await _ask(self._process, task, query, SECONDS_MAX)
            if self._preparing is None:
                self._idle = asyncio.get_running_loop().call_later(IDLE_SECONDS, self._end_idle)
        return _read(*answer)

    async def report(self, query: str) -> bytes:
        """Return a report as HTML, by its query as JSON. Raise ComparisonError."""
        process = await _start(self._database)
        answer = await _ask(process, "report", query, REPORT_SECONDS_MAX)
        await process.end()
        return _read(*answer)

    async def close(self) -> None:
        """End the process."""
        if self._preparing is not None:
            self._preparing.cancel()
        begun = [task for task in (self._preparing, self._leaving) if task is not None]
        await asyncio.gather(*begun, return_exceptions=True)
        if self._idle is not None:
            self._idle.cancel()
        if self._process is not None:
            await self._process.end()

    def _end_idle(self) -> None:
        if self._process is not None and not self._turn.locked():
            self._leaving = asyncio.create_task(self._process.end())
            self._process = None


async def _start(database: Path | str) -> TaskProcess:
    try:
        return await TaskProcess.start("server.features.comparison", str(database))
    except OSError as problem:
        raise ComparisonError(
            f"The sessions cannot be compared: no process can be started for it ({problem.strerror})."
        ) from problem


async def _ask(process: TaskProcess, task: Task, query: str, seconds: float) -> tuple[int, bytes]:
    """Return status and body of the answer.

    Raise ComparisonError where the process ends or takes too long.
    """
    try:
        return await process.ask({"task": task, "query": query}, seconds)
    except TimeoutError:
        raise ComparisonError(
            f"Comparing these sessions was given up after {seconds:.0f} s. Choose fewer sessions or signals."
        ) from None
    except TaskProcessEndedError as end:
        raise ComparisonError(
            f"The sessions cannot be compared: the process that does it {end}. The computer may lack memory. "
            "Try again, with fewer sessions or signals."
        ) from None


def _read(status: int, body: bytes) -> bytes:
    if status != 200:
        raise ComparisonError(body.decode(), status)
    return body
