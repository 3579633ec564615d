"""PID files, by which the next server finds the processes of a killed one."""

import fcntl
import json
import os
import signal
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

TERM_SECONDS = 3.0
LOOK_SECONDS = 0.02
RUNTIME_PAUSED = "runtime.paused"
"""File of the folder `run`. A runtime that systemd starts waits while it exists and the data are claimed."""


def started_at(pid: int) -> int | None:
    """Return a process's start time (clock ticks since the computer's start, proc(5)); None if it has ended.

    PIDs are reused; PID and start time together are unique.
    """
    try:
        # In /proc/PID/stat qemu-user tells a process another start time of its own.
        status = Path(f"/proc/{pid}/task/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    # Behind the program's name in brackets, which may hold brackets itself.
    fields = status.rpartition(")")[2].split()
    state, start = fields[0], fields[19]
    return None if state in "ZX" else int(start)


@dataclass(frozen=True, slots=True)
class Running:
    """A running process: its PID, start time (`started_at`) and the fingerprint of its command."""

    pid: int
    started: int
    fingerprint: str


class PidFile:
    """The PID file `path` of one process."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def write(self, pid: int, fingerprint: str) -> None:
        """Write the file. Raise OSError; the process then runs on, but later servers do not find it."""
        text = json.dumps({"pid": pid, "started": started_at(pid), "made": fingerprint})
        fresh = self._path.with_name(self._path.name + ".new")
        fresh.write_text(text, encoding="utf-8")
        fresh.replace(self._path)

    def read(self) -> Running | None:
        """Return the written process, if it still runs."""
        try:
            document = json.loads(self._path.read_text(encoding="utf-8"))
            running = Running(int(document["pid"]), int(document["started"]), str(document["made"]))
        except (OSError, ValueError, LookupError, TypeError):
            return None
        return running if started_at(running.pid) == running.started else None

    def remove(self) -> None:
        """Remove the file, once the process has ended."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)


def pid_file(run: Path, name: str) -> PidFile:
    """Return the file of the process of this name, in the folder `run`."""
    return PidFile(run / f"{name}.pid")


def running_parts(run: Path) -> dict[str, Running]:
    """Return the processes that still run, by name."""
    processes = {path.stem: PidFile(path).read() for path in run.glob("*.pid")}
    return {name: running for name, running in processes.items() if running is not None}


@contextmanager
def hold_still(run: Path) -> Iterator[None]:
    """Prevent other processes from writing PID files in this folder meanwhile. Raise OSError."""
    handle = os.open(run, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def end_parts(run: Path, but: Collection[str] = ()) -> None:
    """End the processes of a killed server, and wait for their end; those of the names in `but` stay.

    A runtime that systemd starts again waits as long as the caller has claimed the data folder.
    """
    remaining = {name: running for name, running in running_parts(run).items() if name not in but}
    if "runtime" in remaining:
        (run / RUNTIME_PAUSED).touch()
    for running in remaining.values():
        _signal(running.pid, signal.SIGTERM)
    end = time.monotonic() + TERM_SECONDS
    while remaining.keys() & running_parts(run).keys() and time.monotonic() < end:
        time.sleep(LOOK_SECONDS)
    for running in remaining.values():
        _signal(running.pid, signal.SIGKILL)
    for name in remaining:
        pid_file(run, name).remove()


def _signal(pid: int, number: signal.Signals) -> None:
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, number)
