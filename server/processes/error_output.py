"""The standard error of a server: passed on at once, with its last lines stored.

A C library that ends the process gives its reason only there.
"""

import os
from contextlib import suppress

from server.processes.logs import LAST_BYTES, last_lines

READ_BYTES = 65_536
STANDARD_ERROR = 2


class ErrorOutput:
    """A pipe from a forked server to its runner. Close it when the server has ended."""

    def __init__(self) -> None:
        self.handle, self._other_end = os.pipe()
        """`handle` is readable where there is something to pass on."""
        os.set_blocking(self.handle, False)
        self._last = b""

    def become(self) -> None:
        """Make the pipe the standard error of this process, the server."""
        os.dup2(self._other_end, STANDARD_ERROR)

    def pass_on(self) -> None:
        """Copy the server's output to the standard error of this process, its runner."""
        with suppress(BlockingIOError):
            while data := os.read(self.handle, READ_BYTES):
                self._last = (self._last + data)[-LAST_BYTES:]
                _write(data)

    def last(self, count: int) -> str:
        """Return the server's last lines, on one line; empty where there are none."""
        return last_lines(self._last, count)

    def close(self) -> None:
        """Release the pipe."""
        os.close(self.handle)
        os.close(self._other_end)


def _write(data: bytes) -> None:
    # A terminal that is gone, or a full disk: the server serves all the same.
    with suppress(OSError):
        while data:
            data = data[os.write(STANDARD_ERROR, data) :]
