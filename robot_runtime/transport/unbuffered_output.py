"""Output of a process that loses nothing to signals."""

from io import RawIOBase


class UnbufferedOutput:
    """A stream without a buffer that writes all bytes.

    Python's buffered writer has lost bytes where a signal, such as that of a cancel, interrupted its write.
    """

    def __init__(self, stream: RawIOBase) -> None:
        self._stream = stream

    def write(self, data: bytes) -> None:
        """Write all bytes; block until the reader has taken them."""
        rest = memoryview(data)
        while rest:
            rest = rest[self._stream.write(rest) or 0 :]
