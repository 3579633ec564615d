"""Runs `python -m server.features.comparison`: a report costs seconds, which the server has for others."""

import asyncio
import json
import sys
from asyncio.subprocess import PIPE
from pathlib import Path

from server.features.comparison.schemas import ReportQuery
from server.platform.errors import UnavailableError
from server.processes.process import describe_status


class ReportError(UnavailableError):
    """The report cannot be made"""

    def __init__(self, problem: str, status: int = UnavailableError.status) -> None:
        super().__init__(problem)
        self.status = status


async def make_report(database: Path, query: ReportQuery) -> bytes:
    """The report as HTML. Raises ReportError."""
    command = [sys.executable, "-m", "server.features.comparison", str(database)]
    try:
        process = await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE, stderr=PIPE)
    except OSError as problem:
        raise ReportError(
            f"The report cannot be made: no process can be started for it ({problem.strerror})."
        ) from problem
    try:
        output, errors = await process.communicate(query.model_dump_json().encode())
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    if process.returncode == 0:
        return output
    try:
        found = json.loads(output)
        raise ReportError(found["problem"], found["status"])
    except ValueError as problem:
        said = errors.decode(errors="replace").strip().rpartition("\n")[2]
        raise ReportError(
            f"The report cannot be made: its process {describe_status(process.returncode)}. {said}".strip()
        ) from problem
