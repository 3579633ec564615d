"""Runs `python -m server.features.exports` and reads its reports."""

import json
import sys
from collections.abc import Callable
from signal import SIGTERM
from typing import Any

from server.processes.process import PipedProcess, describe_status

WORDS_BYTES = 2_000
"""Of what is no JSON the end is kept: the last words of a process that fails."""


class ExportProcessError(Exception):
    """The work could not be done; the text says why."""


class ExportProcess:
    """One such process; call `run` once."""

    def __init__(self, arguments: list[str], progress: Callable[[float], None]) -> None:
        self._arguments = arguments
        self._progress = progress
        self._process: PipedProcess | None = None
        self._cancelled = False
        self._partial = b""
        self._words = b""
        self._last: dict[str, Any] = {}

    async def run(self) -> dict[str, Any]:
        """Run to the end; the last message of the process. Raises ExportProcessError with the reason."""
        try:
            self._process = PipedProcess(
                [sys.executable, "-m", "server.features.exports", *self._arguments], self._hear
            )
        except OSError as problem:
            raise ExportProcessError(f"A process for it cannot be started: {problem.strerror}.") from problem
        try:
            status = await self._process.wait()
        finally:
            self._process.close()
        if self._cancelled:
            raise ExportProcessError("It was cancelled.")
        if "problem" in self._last:
            raise ExportProcessError(str(self._last["problem"]))
        if status != 0:
            words = self._words.decode(errors="replace").strip()
            said = f" Its last words: {words.splitlines()[-1]}" if words else ""
            raise ExportProcessError(f"The process for it {describe_status(status)}.{said}")
        return self._last

    def cancel(self) -> None:
        """End it soon."""
        self._cancelled = True
        if self._process is not None:
            self._process.signal(SIGTERM)

    def _hear(self, data: bytes) -> None:
        *lines, self._partial = (self._partial + data).split(b"\n")
        for line in lines:
            try:
                document = json.loads(line)
            except ValueError:
                document = None
            if not isinstance(document, dict):
                self._words = (self._words + line + b"\n")[-WORDS_BYTES:]
            elif "progress" in document:
                self._progress(document["progress"])
            else:
                self._last = document
