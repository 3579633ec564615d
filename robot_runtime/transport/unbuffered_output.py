"""Output of a process that bears signals."""

from io import RawIOBase


class UnbufferedOutput:
    """Writes all bytes to a stream without a buffer.

    Python's buffered writer has lost bytes where a signal, such as that of a cancel, interrupted its write.
    """

    def __init__(self, stream: RawIOBase) -> None:
        self._stream = stream

    def write(self, data: bytes) -> None:
        """Writes all of it; blocks until the reader has taken it."""
        rest = memoryview(data)
        while rest:
            rest = rest[self._stream.write(rest) or 0 :]
