"""Free space on the disk that holds the data folder, and writing that fails without it."""

import errno
import shutil
from pathlib import Path

from server.platform.errors import InsufficientStorageError
from server.platform.settings import DataFolder

DIVE_BYTES = 20_000_000
"""An hour of recording without pictures; with less free space a dive cannot be recorded."""
SPARE_BYTES = 50_000_000
"""Disk space that is left free for recordings."""


class FileWriteError(InsufficientStorageError):
    """The disk is full"""


def free_bytes(path: Path) -> int:
    """Return the free bytes of the disk that holds this path."""
    return shutil.disk_usage(path).free


def check_room(folder: DataFolder) -> None:
    """Raise FileWriteError where there is no room to record a dive."""
    free = free_bytes(folder.path)
    if free < DIVE_BYTES:
        raise FileWriteError(
            f"The disk is full: {free / 1e6:.0f} MB are free, and a dive that is recorded needs "
            f"{DIVE_BYTES / 1e6:.0f} MB. Remove sessions or exports."
        )


def require_free(folder: Path, size: int) -> None:
    """Raise FileWriteError where these bytes would leave too little room for recordings."""
    free = free_bytes(folder)
    if free < size + SPARE_BYTES:
        raise FileWriteError(
            f"The disk that holds {folder} has {free / 1e6:.0f} MB free; this needs "
            f"{(size + SPARE_BYTES) / 1e6:.0f} MB. Free some space, and try again."
        )


def explain_write_error(problem: OSError, path: Path) -> str:
    """Return the cause of a failed write to `path`, and the remedy."""
    if problem.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return f"The disk that holds {path.parent} is full. Free some space, and try again."
    return f"{path.parent} cannot be written: {problem.strerror or problem}."
