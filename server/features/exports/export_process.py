"""Runs `python -m server.features.exports` and reads its reports."""

import asyncio
import json
import sys
from collections.abc import Callable
from signal import SIGKILL, SIGTERM
from typing import Any

from server.processes.exit_status import describe_status
from server.processes.process import PipedProcess

ERROR_BYTES = 2_000
"""Length of the stored end of the output that is no JSON, which explains a failure."""
CANCEL_SECONDS = 3.0
"""Time that a cancelled process has to end by itself."""
SILENT_SECONDS = 600.0
"""Time without a report after which a process counts as hung: it reports several times a second."""


class ExportProcessError(Exception):
    """The process failed; the text says why."""


class ExportProcess:
    """One process; call `run` once."""

    def __init__(self, arguments: list[str], progress: Callable[[float], None]) -> None:
        self._arguments = arguments
        self._progress = progress
        self._process: PipedProcess | None = None
        self._loop = asyncio.get_running_loop()
        self._watch: asyncio.TimerHandle | None = None
        self._ended_because = ""
        self._partial = b""
        self._errors = b""
        self._last: dict[str, Any] = {}

    async def run(self) -> dict[str, Any]:
        """Run the process and return its last message. Raises ExportProcessError with the reason."""
        try:
            self._process = PipedProcess(
                [sys.executable, "-m", "server.features.exports", *self._arguments], self._read_output
            )
        except OSError as problem:
            raise ExportProcessError(f"A process for it cannot be started: {problem.strerror}.") from problem
        if self._ended_because:
            self._process.signal(SIGKILL)
        self._see_alive()
        try:
            status = await self._process.wait()
        finally:
            self._process.close()
            if self._watch is not None:
                self._watch.cancel()
        if self._ended_because:
            raise ExportProcessError(self._ended_because)
        if "problem" in self._last:
            raise ExportProcessError(str(self._last["problem"]))
        if status != 0:
            errors = self._errors.decode(errors="replace").strip()
            end = f" Its last output: {errors.splitlines()[-1]}" if errors else ""
            raise ExportProcessError(f"The process for it {describe_status(status)}.{end}")
        return self._last

    def cancel(self, reason: str = "It was cancelled.") -> None:
        """End the process, by force where it does not end by itself; `run` raises the reason."""
        self._ended_because = reason
        if self._process is not None:
            self._process.signal(SIGTERM)
            self._loop.call_later(CANCEL_SECONDS, self._process.signal, SIGKILL)

    def _see_alive(self) -> None:
        if self._watch is not None:
            self._watch.cancel()
        self._watch = self._loop.call_later(SILENT_SECONDS, self._end_hung)

    def _end_hung(self) -> None:
        self.cancel(f"The process for it made no progress for {SILENT_SECONDS / 60:.0f} minutes.")

    def _read_output(self, data: bytes) -> None:
        self._see_alive()
        *lines, self._partial = (self._partial + data).split(b"\n")
        for line in lines:
            try:
                document = json.loads(line)
            except ValueError:
                document = None
            if not isinstance(document, dict):
                self._errors = (self._errors + line + b"\n")[-ERROR_BYTES:]
            elif "progress" in document:
                self._progress(document["progress"])
            else:
                self._last = document
