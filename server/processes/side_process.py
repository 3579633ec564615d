"""A program of ours in a process of its own, which prints documents: JSON objects, one to a line."""

import asyncio
import json
import logging
import sys
import tempfile
from collections import deque
from collections.abc import AsyncIterator, Mapping, Sequence
from signal import Signals
from types import MappingProxyType
from typing import Any, Self

from server.processes.exit_status import describe_status
from server.processes.process import PipedProcess

log = logging.getLogger(__name__)

LINE_BYTES_MAX = 16_000_000
"""The rest of a longer line counts."""
WORDS_MOST, WORD_BYTES = 5, 10_000
"""Stored lines that are no documents, and their length."""
NOTHING: Mapping[str, str] = MappingProxyType({})


class SideProcess:
    """`python -m MODULE ARGUMENTS`; as a context, it ends with the process and its children.

    `given` is its standard input. `words` are the last lines that are no documents: they explain a failure.
    Raises OSError where it cannot be started.
    """

    def __init__(
        self,
        module: str,
        arguments: Sequence[str],
        given: bytes = b"",
        environment: Mapping[str, str] = NOTHING,
    ) -> None:
        self.last_lines: deque[str] = deque(maxlen=WORDS_MOST)
        self._module = module
        self._lines: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._partial = b""
        with tempfile.TemporaryFile() as file:
            file.write(given)
            file.seek(0)
            command = [sys.executable, "-m", module, *arguments]
            self._process = PipedProcess(command, self._take, file, environment)
        self._ending = asyncio.create_task(self._see_end())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.cancel()
        self._process.close()

    async def documents(self) -> AsyncIterator[dict[str, Any]]:
        """Yield each document when it is printed, until the process has ended."""
        while (line := await self._lines.get()) is not None:
            document = _read(line)
            if document is not None:
                yield document
            elif text := line[-WORD_BYTES:].decode(errors="replace").strip():
                log.warning("%s: %s", self._module, text)
                self.last_lines.append(text)

    async def wait(self) -> int | None:
        """Wait for the end and return the exit status."""
        return await self._process.wait()

    async def describe_end(self) -> str:
        """Wait for the end and describe it, in words that follow the name of the process."""
        return f"{describe_status(await self.wait())}. {' / '.join(self.last_lines)}".strip()

    def signal(self, number: Signals) -> None:
        """Send a signal to the process and its children."""
        self._process.signal(number)

    def _take(self, data: bytes) -> None:
        *whole, self._partial = (self._partial + data).split(b"\n")
        self._partial = self._partial[-LINE_BYTES_MAX:]
        for line in whole:
            self._lines.put_nowait(line)

    async def _see_end(self) -> None:
        await self._process.wait()
        self._take(b"\n")
        self._lines.put_nowait(None)


def _read(line: bytes) -> dict[str, Any] | None:
    try:
        document = json.loads(line)
    except ValueError:
        return None
    return document if isinstance(document, dict) else None
