"""Report of the present or last update, readable by everybody; gone after a restart of the computer."""

import fcntl
import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from robot_runtime.durable_files import PART
from server.platform.pidfile import started_at
from server.platform.settings import SetupError

ReportPhase = Literal["running", "done", "failed"]
CUT_OFF = "The update was ended before its end. Begin it again: what was half done is put back first."


@dataclass(frozen=True, slots=True)
class Report:
    """A running or ended update; `time` is in s since 1970."""

    phase: ReportPhase
    text: str
    time: float


class UpdateReport:
    """The file of the report. A report that cannot be written does not prevent an update."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def write(self, phase: ReportPhase, text: str) -> None:
        """Write the present step, or the outcome."""
        document = asdict(Report(phase, text, time.time()))
        made = {"pid": os.getpid(), "started": started_at(os.getpid())}
        part = self._path.with_name(self._path.name + PART)
        with suppress(OSError):
            part.write_text(json.dumps(document | made), encoding="utf-8")
            part.chmod(0o644)
            part.replace(self._path)

    def read(self) -> Report | None:
        """Return the newest report; None without one. For a dead process it reports that."""
        try:
            document = json.loads(self._path.read_text(encoding="utf-8"))
            report = Report(document["phase"], str(document["text"]), float(document["time"]))
            alive = started_at(int(document["pid"])) == document["started"]
        except (OSError, ValueError, LookupError, TypeError):
            return None
        return report if alive or report.phase != "running" else Report("failed", CUT_OFF, report.time)


@contextmanager
def hold(path: Path) -> Iterator[None]:
    """Hold the installation's lock. Raise SetupError where another process has it.

    Nobody but root can open the lock, so that nobody else can hold up an update.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as problem:
        raise SetupError("The installation is being changed already. Wait for the end of that.") from problem
    else:
        yield
    finally:
        os.close(handle)
