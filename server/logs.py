"""What a supervised process prints: kept in a file of bounded size, and its last lines in memory."""

from collections import deque
from pathlib import Path
from typing import BinaryIO

FILE_BYTES_MAX = 1_000_000
LINES_KEPT = 20
LINE_BYTES_MAX = 2_000


class PartLog:
    """Writes to `path`; when that is full it becomes `path`.1, and a new one is begun."""

    def __init__(self, path: Path) -> None:
        self.lines: deque[str] = deque(maxlen=LINES_KEPT)
        self._path = path
        self._file: BinaryIO | None = None
        self._partial = b""

    def write(self, data: bytes) -> None:
        """Keep these bytes. A full disk costs the file its lines, and nobody else anything."""
        *whole, self._partial = (self._partial + data).split(b"\n")
        self._partial = self._partial[-LINE_BYTES_MAX:]
        self.lines.extend(
            line[-LINE_BYTES_MAX:].decode(errors="replace").rstrip() for line in whole if line.strip()
        )
        try:
            self._append(data)
        except OSError:
            self.close()

    def last(self, count: int) -> str:
        """The last lines, one after the other; empty where nothing was printed."""
        lines = [*self.lines, self._partial.decode(errors="replace").strip()]
        return " / ".join([line for line in lines if line][-count:])

    def close(self) -> None:
        """Close the file."""
        file, self._file = self._file, None
        if file is not None:
            try:
                file.close()
            except OSError:
                return

    def _append(self, data: bytes) -> None:
        if self._file is None:
            self._file = self._path.open("ab", buffering=0)
        if self._file.tell() + len(data) > FILE_BYTES_MAX:
            self._file.close()
            self._path.replace(self._path.with_name(self._path.name + ".1"))
            self._file = self._path.open("ab", buffering=0)
        self._file.write(data)
