"""A host at the serial port of a paused emulated board: time passes only while the host waits.

What is written is on the board's side before any time passes, so that a run gives the same bytes every time.
"""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

from robot_runtime.comm_test.results import LineErrors
from robot_runtime.link.port import Port
from robot_runtime.simulation.board import BoardError, BoardProcess

PATIENCE = 10.0
"""s of real time for what the operating system does between two processes."""
BITS_PER_BYTE = 10
START_TIME = 0.02
"""s of emulated time until the sketch listens."""
WRITE_BUFFER_BYTES = 4000
"""A little less than Linux keeps for a serial port; a longer write waits for the line."""
READ_STEP_BYTES = 1024
RUN_MIN = 1e-6
"""s; the board tells its time with six digits."""


class EmulatedLine:
    """The board with this program on it, reset, and its port opened at `baud` (bit/s).

    `now` is emulated time in s, `written` and `heard` are what went over the port.

    Raises BoardError and PortError.
    """

    def __init__(self, program: Path, elf: Path, folder: Path, baud: int) -> None:
        self.byte_time = BITS_PER_BYTE / baud
        self._process = BoardProcess(
            program, elf, folder / "tty", folder / "socket", "--paused", "--with-parent"
        )
        try:
            self._board = self._process.connect()
            self._port = Port(str(self._process.tty), baud)
        except Exception:
            self._process.stop()
            raise
        self.written = 0
        self.heard = b""
        self.now = 0.0
        self._line_free = 0.0
        self._wait_for(lambda: self._count("baud_host") == baud)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._port.close()
        self._board.close()
        self._process.stop()

    @property
    def busy(self) -> float:
        """s until everything that was written is through the line."""
        return max(self._line_free - self.now, 0.0)

    def write(self, data: bytes) -> None:
        """Hand bytes to the port, waiting for the line where they find no room. Raises BoardError."""
        room = WRITE_BUFFER_BYTES * self.byte_time
        airtime = len(data) * self.byte_time
        if self.busy + airtime > room:
            self.wait(self.busy + airtime - room)
        self._port.write(data)
        self.written += len(data)
        self._line_free = self.now + self.busy + airtime
        self._wait_for(lambda: self._count("bytes_from_host") == self.written)

    def wait(self, seconds: float) -> None:
        """Let emulated time pass, and read what comes meanwhile into `heard`. Raises BoardError."""
        end = self.now + seconds
        step = READ_STEP_BYTES * self.byte_time
        while (left := end - self.now) > RUN_MIN:
            self.now = self._board.run(min(left, step))
            self._read()

    def errors(self) -> LineErrors:
        """What the two UARTs have counted since the start."""
        stats = self._board.stats()
        return LineErrors(
            int(stats["framing_errors_board"]), int(stats["framing_errors_host"]), int(stats["overruns"])
        )

    def _read(self) -> None:
        given = self._count("bytes_to_host")

        def complete() -> bool:
            if len(self.heard) < given and self._port.wait(0.001):
                self.heard += self._port.read()
            return len(self.heard) >= given

        self._wait_for(complete)

    def _count(self, name: str) -> int:
        return int(self._board.stats()[name])

    def _wait_for(self, condition: Callable[[], bool]) -> None:
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise BoardError("the emulated board does not serve its serial port")
            os.sched_yield()
