"""The serial port of a paused emulated board, in step with it: no time passes while bytes are in transit.

What is written is on the board's side before any time passes, and all that the board has handed over is read
before any more does, so that a run gives the same bytes every time.
"""

import os
import time
from collections.abc import Callable
from pathlib import Path

from robot_runtime.link.port import Port
from robot_runtime.simulation.boards.emulator_process import BoardError, EmulatorClient

PATIENCE = 60.0
"""s of real time for what the operating system does between two processes, on a busy computer."""


class PausedPort:
    """The port at `tty`, opened at this speed, and the board's power switched off and on then.

    So what the board did before makes no difference, but for its memories. Raises BoardError and PortError.
    """

    def __init__(self, board: EmulatorClient, tty: Path, baud: int) -> None:
        self.written = 0
        self.read = 0
        self._board = board
        self._port = Port(str(tty), baud)
        try:
            self._wait_for(lambda: self.count("baud_host") == baud)
            board.power()
        except Exception:
            self._port.close()
            raise

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def count(self, counter: str) -> int:
        """Returns the board's counter of this name."""
        return int(self._board.stats()[counter])

    def write(self, data: bytes) -> None:
        """Hand these bytes to the board."""
        self._port.write(data)
        self.written += len(data)
        self._wait_for(lambda: self.count("bytes_from_host") == self.written)

    def receive(self) -> bytes:
        """All that the board has handed over since the last time."""
        given, data = self.count("bytes_to_host"), b""

        def complete() -> bool:
            nonlocal data
            if self.read + len(data) < given and self._port.wait(0.001):
                data += self._port.read()
            return self.read + len(data) >= given

        self._wait_for(complete)
        self.read += len(data)
        return data

    def _wait_for(self, condition: Callable[[], bool]) -> None:
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise BoardError("the emulated board does not serve its serial port")
            os.sched_yield()
