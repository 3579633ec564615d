"""Files written whole or not at all, with their checksum."""

import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import BinaryIO, NamedTuple, cast

from robot_runtime import durable_files
from server.platform.disk_space import FileWriteError, explain_write_error

BUFFER_BYTES = 1 << 18


class WrittenFile(NamedTuple):
    """A file's size in bytes and its SHA-256 in hexadecimal."""

    bytes: int
    sha256: str


def write_part(path: Path, write: Callable[[BinaryIO], object]) -> WrittenFile:
    """Write a file to the disk; it is removed again if anything fails.

    Raise FileWriteError, and the errors of `write`.
    """
    try:
        with path.open("wb", buffering=BUFFER_BYTES) as file:
            summed = _ChecksumWriter(file)
            write(cast("BinaryIO", summed))
            file.flush()
            os.fsync(file.fileno())
    except OSError as problem:
        path.unlink(missing_ok=True)
        raise FileWriteError(explain_write_error(problem, path)) from problem
    except BaseException:
        path.unlink(missing_ok=True)
        raise
    return WrittenFile(summed.tell(), summed.sha256)


def put_in_place(part: Path, path: Path) -> None:
    """Rename a finished file durably. Raise FileWriteError."""
    try:
        durable_files.put_in_place(part, path)
    except OSError as problem:
        raise FileWriteError(explain_write_error(problem, path)) from problem


class _ChecksumWriter:
    """A file that counts the written bytes and computes their checksum."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._sum = hashlib.sha256()
        self._count = 0

    @property
    def sha256(self) -> str:
        return self._sum.hexdigest()

    def write(self, data: bytes) -> int:
        self._sum.update(data)
        self._file.write(data)
        size = memoryview(data).nbytes
        self._count += size
        return size

    def writelines(self, pieces: Iterable[bytes]) -> None:
        for piece in pieces:
            self.write(piece)

    def tell(self) -> int:
        return self._count

    def flush(self) -> None:
        self._file.flush()
