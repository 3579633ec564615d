"""The process `python -m server.features.exports` and its reports."""

import asyncio
from collections.abc import Callable
from signal import SIGKILL
from typing import Any

from server.processes.side_process import SideProcess

SILENT_SECONDS = 600.0
"""Time without a report after which a process counts as hung: it reports several times a second."""


class ExportProcessError(Exception):
    """The process failed; the text says why."""


class ExportProcess:
    """One process; call `run` once."""

    def __init__(self, arguments: list[str], progress: Callable[[float], None]) -> None:
        self._arguments = arguments
        self._progress = progress
        self._process: SideProcess | None = None
        self._cancelled_because = ""

    async def run(self) -> dict[str, Any]:
        """Run the process and return its last message. Raise ExportProcessError with the reason."""
        try:
            self._process = SideProcess("server.features.exports", self._arguments)
        except OSError as problem:
            raise ExportProcessError(f"A process for it cannot be started: {problem.strerror}.") from problem
        with self._process as process:
            try:
                last = await self._read(process)
            except TimeoutError:
                minutes = f"{SILENT_SECONDS / 60:.0f} minutes"
                raise ExportProcessError(f"The process for it made no progress for {minutes}.") from None
            if self._cancelled_because:
                raise ExportProcessError(self._cancelled_because)
            if "problem" in last:
                raise ExportProcessError(str(last["problem"]))
            if await process.wait() != 0:
                raise ExportProcessError(f"The process for it {await process.describe_end()}")
            return last

    def cancel(self, reason: str = "It was cancelled.") -> None:
        """End the process; `run` raises the reason."""
        self._cancelled_because = reason
        if self._process is not None:
            self._process.signal(SIGKILL)

    async def _read(self, process: SideProcess) -> dict[str, Any]:
        """Read the reports and return the last one. Raise TimeoutError."""
        last: dict[str, Any] = {}
        loop = asyncio.get_running_loop()
        if self._cancelled_because:
            process.signal(SIGKILL)
        async with asyncio.timeout(SILENT_SECONDS) as silence:
            async for document in process.documents():
                silence.reschedule(loop.time() + SILENT_SECONDS)
                if "progress" in document:
                    self._progress(document["progress"])
                else:
                    last = document
        return last
