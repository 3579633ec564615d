"""Files that survive a power cut: whole under their name, or not there."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PART = ".part"
"""Ends the name of a file that is not whole yet."""
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_TRUNC


def write_whole(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file, in place of an older one, for good. Raises OSError; then the older one is still there."""
    with unfinished(path) as part, os.fdopen(os.open(part, _WRITE, mode), "wb") as file:
        file.write(data)


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """Yield the name under which to write a file; then put it in place, for good.

    Where anything fails, it is removed, and an older file is still there. Raises OSError.
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
    """Rename a finished file, for good. Raises OSError."""
    part.replace(path)
    sync(path.parent)


def make_folder(path: Path) -> None:
    """Make a folder and those it lies in, for good. Raises OSError."""
    if path.is_dir():
        return
    make_folder(path.parent)
    path.mkdir(exist_ok=True)
    sync(path.parent)


def sync(path: Path) -> None:
    """Have a file's bytes, or a folder's names, on the disk. Raises OSError."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
