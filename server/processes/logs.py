"""Logs of supervised processes; each writes its file itself, without the server."""

import os
from pathlib import Path
from typing import IO

FILE_BYTES_MAX = 1_000_000
LAST_BYTES = 8_000
LINE_BYTES_MAX = 2_000
LINES_SHOWN = 3
"""Of a process that has ended."""


class ProcessLog:
    """The log file `path` and the one before it, `path`.1; together about twice `FILE_BYTES_MAX`."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def open(self) -> IO[bytes]:
        """Open the file for a process to write. On a full disk its lines are lost, without further effect."""
        try:
            return self._path.open("ab", buffering=0)
        except OSError:
            return Path(os.devnull).open("ab", buffering=0)

    def trim(self) -> None:
        """Move the content to `path`.1 where it has grown too long; the process goes on writing to `path`."""
        try:
            if self._path.stat().st_size <= FILE_BYTES_MAX:
                return
            with self._path.open("r+b") as file:
                file.seek(-FILE_BYTES_MAX, os.SEEK_END)
                self._path.with_name(self._path.name + ".1").write_bytes(file.read())
                file.truncate(0)
        except OSError:
            return

    def size(self) -> int:
        """Return the size of the file in bytes."""
        try:
            return self._path.stat().st_size
        except OSError:
            return 0

    def last(self, count: int, since: int = 0) -> str:
        """Return the last `count` lines after the first `since` bytes, on one line; empty without lines."""
        try:
            with self._path.open("rb") as file:
                size = file.seek(0, os.SEEK_END)
                file.seek(max(since if since <= size else 0, size - LAST_BYTES))
                return last_lines(file.read(), count)
        except OSError:
            return ""


def last_lines(data: bytes, count: int) -> str:
    """Return the last `count` lines, on one line, without empty ones."""
    lines = [line.strip() for line in data.splitlines()]
    chosen = [line[-LINE_BYTES_MAX:] for line in lines if line][-count:]
    return " / ".join(line.decode(errors="replace") for line in chosen)
