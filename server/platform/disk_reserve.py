"""A file that reserves disk space, and is removed for deletions when the disk is full."""

import logging
import os
from pathlib import Path

from robot_runtime.durable_files import unfinished
from server.platform.disk_space import free_bytes

log = logging.getLogger(__name__)

RESERVE_BYTES = 8_000_000
"""More than SQLite's log grows to while samples are deleted."""


class DiskReserve:
    """The reserve of one data folder. Used in the thread that writes the database."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def make(self) -> None:
        """Reserve the space, where twice as much is free."""
        if self._path.exists() or free_bytes(self._path.parent) < 2 * RESERVE_BYTES:
            return
        try:
            with unfinished(self._path) as part:
                handle = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
                try:
                    os.posix_fallocate(handle, 0, RESERVE_BYTES)
                finally:
                    os.close(handle)
        except OSError as problem:
            log.warning("no room was set aside for deletions in %s: %s", self._path, problem)

    def give_up(self) -> bool:
        """Free the space; return False where none was reserved."""
        try:
            self._path.unlink()
        except OSError:
            return False
        return True
