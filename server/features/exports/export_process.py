"""Runs `python -m server.features.exports` and reads its reports."""

import json
import sys
from collections.abc import Callable
from signal import SIGTERM
from typing import Any

from server.processes.exit_status import describe_status
from server.processes.process import PipedProcess

ERROR_BYTES = 2_000
"""Length of the stored end of the output that is no JSON, which explains a failure."""


class ExportProcessError(Exception):
    """The process failed; the text says why."""


class ExportProcess:
    """One process; call `run` once."""

    def __init__(self, arguments: list[str], progress: Callable[[float], None]) -> None:
        self._arguments = arguments
        self._progress = progress
        self._process: PipedProcess | None = None
        self._cancelled = False
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
        try:
            status = await self._process.wait()
        finally:
            self._process.close()
        if self._cancelled:
            raise ExportProcessError("It was cancelled.")
        if "problem" in self._last:
            raise ExportProcessError(str(self._last["problem"]))
        if status != 0:
            errors = self._errors.decode(errors="replace").strip()
            end = f" Its last output: {errors.splitlines()[-1]}" if errors else ""
            raise ExportProcessError(f"The process for it {describe_status(status)}.{end}")
        return self._last

    def cancel(self) -> None:
        """Terminate the process."""
        self._cancelled = True
        if self._process is not None:
            self._process.signal(SIGTERM)

    def _read_output(self, data: bytes) -> None:
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
