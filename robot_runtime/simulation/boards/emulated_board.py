"""The emulated board, paused and stepped through its socket, with a host at its serial port."""

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from robot_runtime.config import LinkConfig
from robot_runtime.link.port import Port
from robot_runtime.simulation.boards.emulator_process import (
    BoardError,
    EmulatorClient,
    EmulatorProcess,
    FaultKind,
    Water,
)
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard

PATIENCE = 60.0
"""s of real time for bytes to pass between two processes, on a busy computer."""


class PausedPort:
    """The serial port of a paused board, in step with it: no emulated time passes while bytes are in transit.

    So a run gives the same bytes every time. Construction opens `tty` at this speed and power-cycles the
    board. Raises BoardError and PortError.
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
        """Return the board's counter of this name."""
        return int(self._board.stats()[counter])

    def write(self, data: bytes) -> None:
        """Send these bytes, and return when the board has them."""
        self._port.write(data)
        self.written += len(data)
        self._wait_for(lambda: self.count("bytes_from_host") == self.written)

    def receive(self) -> bytes:
        """Return all bytes that the board has sent since the last call."""
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


class EmulatedBoard(SteppedBoard):
    """The program `elf` on the emulated chip. Raises BoardError and PortError."""

    def __init__(self, program: Path, elf: Path, water: Water) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="mucat-")
        folder = Path(self._folder.name)
        try:
            options = ("--paused", "--with-parent")
            self._process = EmulatorProcess(program, elf, folder / "tty", folder / "board", *options)
        except Exception:
            self._folder.cleanup()
            raise
        try:
            self.firmware = elf.read_bytes()
            self._board = self._process.connect()
            self._port = PausedPort(self._board, self._process.tty, LinkConfig().baud)
            self._board.attach(PERIOD, water)
        except Exception:
            self._process.stop()
            self._folder.cleanup()
            raise

    def run(self, periods: int) -> bytes:
        """Advance by this many periods; return the bytes for the host."""
        self._board.run(periods * PERIOD)
        return self._port.receive()

    def write(self, data: bytes) -> None:
        """Send these bytes to the board."""
        self._port.write(data)

    def fault(self, device: str, kind: FaultKind) -> None:
        """Set or clear the fault of a device."""
        self._board.fault(device, kind)

    def mistake(self, text: str) -> None:
        """Add a mistake of wiring, or an imperfection of a part."""
        self._board.mistake(text)

    def line(self, command: str) -> None:
        """Set a fault of the line by a command such as `line to_board cut on`."""
        self._board.command(command)

    def seed_line(self, seed: int) -> None:
        """Seed the faults of the line."""
        self._board.seed_line(seed)

    def reset(self) -> None:
        """Pull the reset pin."""
        self._board.reset()

    def close(self) -> None:
        """End the board."""
        self._port.close()
        self._board.close()
        self._process.stop()
        self._folder.cleanup()
