"""Atomic, durable writing of files: after a power cut a file is complete or absent."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PART = ".part"
"""Suffix of a file that is still being written."""
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_TRUNC


def write_whole(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file durably, replacing an older one. Raise OSError; then the older one is unchanged."""
    with unfinished(path) as part, os.fdopen(os.open(part, _WRITE, mode), "wb") as file:
        file.write(data)


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to, and rename it to `path` afterwards, durably.

    On failure the temporary file is removed and an older file is unchanged. Raise OSError.
    """
    part = path.with_name(path.name + PART)
    try:
        yield part
        sync(part)
        put_in_place(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def put_in_place(part: Path, path: Path) -> None:
    """Rename a finished file, durably. Raise OSError."""
    part.replace(path)
    sync(path.parent)


def make_folder(path: Path) -> None:
    """Make a folder and its parents, durably. Raise OSError."""
    if path.is_dir():
        return
    make_folder(path.parent)
    path.mkdir(exist_ok=True)
    sync(path.parent)


def keep_private() -> None:
    """Make files of this process and its children readable and writable by their user alone."""
    os.umask(0o077)


def sync(path: Path) -> None:
    """Flush a file, or the names in a folder, to the disk. Raise OSError."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
