"""The lock of a data folder: one process at a time writes in it."""

import fcntl
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO

from robot_runtime.durable_files import make_folder
from server.platform.audit_file import append_shell_command
from server.platform.pidfile import PidFile
from server.platform.settings import DataFolder, SetupError, make_folders

log = logging.getLogger(__name__)

LOCK_TRIES = 20
LOCK_SECONDS = 0.02


class FolderInUseError(SetupError):
    """Another server works on the data folder."""


@contextmanager
def claim(folder: DataFolder) -> Iterator[None]:
    """Lock the data folder for this process alone.

    Raise FolderInUseError where another server has it, SetupError where it cannot be used.

    The other processes of a killed server test the lock now and then, and so hold it for a moment.
    """
    try:
        make_folder(folder.path)
        handle = folder.lock.open("w")
    except OSError as problem:
        raise SetupError(f"The data folder {folder.path} cannot be used: {problem.strerror}.") from problem
    with handle:
        if not _lock(handle):
            runner = runner_of(folder)
            process = f" (process {runner})" if runner is not None else ""
            raise FolderInUseError(
                f"Another server works on {folder.path}{process}. End it, or choose another folder with "
                "--data."
            )
        make_folders(folder)
        record_command(folder)
        yield


def record_command(folder: DataFolder) -> None:
    """Write the shell's present command into the audit log; the command goes on if that fails."""
    try:
        append_shell_command(folder.audit)
    except OSError as problem:
        log.warning("the audit log does not say what this command does: %s", problem)


def runner_of(folder: DataFolder) -> int | None:
    """Return the process ID of the runner of this folder; None where none runs."""
    running = PidFile(folder.runner).read()
    return None if running is None else running.pid


def _lock(handle: IO[str]) -> bool:
    for _ in range(LOCK_TRIES):
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(LOCK_SECONDS)
        else:
            return True
    return False
