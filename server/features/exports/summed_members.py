"""Members of an archive with their checksums."""

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO

from robot_runtime.contract.archive import CHECKSUMS
from server.features.exports.zip_stream import ZipWriter


class SummedMembers:
    """Members of the zip file, and their checksums."""

    def __init__(self, output: BinaryIO) -> None:
        self._packing = ZipWriter(output, packed=False)
        self._sums: dict[str, str] = {}

    @contextmanager
    def member(self, name: str) -> Iterator[Any]:
        """Open a member; yield the function that writes it."""
        checksum = hashlib.sha256()
        with self._packing.member(name) as file:

            def write(data: bytes) -> None:
                checksum.update(data)
                file.write(data)

            yield write
        self._sums[name] = checksum.hexdigest()

    def close(self) -> None:
        """Write the checksums, and end the file."""
        self._packing.text(CHECKSUMS, json.dumps(self._sums, indent=1))
        self._packing.close()
