"""Report of the present or last update, for everybody to read; gone when the computer starts anew."""

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
    """An update as it goes, or as it ended; `time` is in s since 1970."""

    phase: ReportPhase
    text: str
    time: float


class UpdateReport:
    """The file of the report. A report that cannot be written hinders no update."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def write(self, phase: ReportPhase, text: str) -> None:
        """Write what is being done, or how it ended."""
        found = asdict(Report(phase, text, time.time()))
        made = {"pid": os.getpid(), "started": started_at(os.getpid())}
        part = self._path.with_name(self._path.name + PART)
        with suppress(OSError):
            part.write_text(json.dumps(found | made), encoding="utf-8")
            part.chmod(0o644)
            part.replace(self._path)

    def read(self) -> Report | None:
        """The newest report; None without one. Of a process that has died it says so."""
        try:
            found = json.loads(self._path.read_text(encoding="utf-8"))
            report = Report(found["phase"], str(found["text"]), float(found["time"]))
            alive = started_at(int(found["pid"])) == found["started"]
        except (OSError, ValueError, LookupError, TypeError):
            return None
        return report if alive or report.phase != "running" else Report("failed", CUT_OFF, report.time)


@contextmanager
def hold(path: Path) -> Iterator[None]:
    """Change the installation alone. Raises SetupError where it is being changed already.

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
