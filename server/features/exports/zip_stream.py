"""A zip file that is written in one pass, never in memory as a whole. Same input, same bytes."""

import io
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any, BinaryIO

LEVEL = 1
"""zlib's fastest: on a Raspberry Pi Zero the rest gains little and costs much."""


class ZipWriter:
    """A zip file around `output`, whose members are deflated where `packed`, else stored as they are."""

    def __init__(self, output: BinaryIO, *, packed: bool = True) -> None:
        kind = zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED
        self._archive = zipfile.ZipFile(ForwardOnly(output), "w", kind, compresslevel=LEVEL)

    def text(self, name: str, text: str) -> None:
        """Write a member with this text."""
        with self.member(name) as file:
            file.write(text.encode())

    @contextmanager
    def member(self, name: str) -> Iterator[IO[bytes]]:
        """Open a member for writing; one at a time. Given as a name, zipfile does not date it today."""
        with self._archive.open(name, "w", force_zip64=True) as file:
            yield file

    def close(self) -> None:
        """Write the list of members."""
        self._archive.close()


class ForwardOnly(io.RawIOBase):
    """A file without seeking, as for a download."""

    def __init__(self, output: BinaryIO) -> None:
        self._output = output

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, data: Any) -> int:
        """Write all bytes; return their number."""
        self._output.write(data)
        return len(data)
