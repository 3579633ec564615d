"""The emulated board, paused, stepped by its socket with a host at its serial port."""

import tempfile
from pathlib import Path

from robot_runtime.config import LinkConfig
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess, FaultKind
from robot_runtime.simulation.boards.paused_port import PausedPort
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard, Water


class EmulatedBoard(SteppedBoard):
    """The program `elf` on the emulated chip. Raises BoardError and PortError where that cannot be."""

    def __init__(self, program: Path, elf: Path, water: Water) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="mucat-")
        place = Path(self._folder.name)
        try:
            options = ("--paused", "--with-parent")
            self._process = EmulatorProcess(program, elf, place / "tty", place / "board", *options)
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
        """Advances by this many periods; returns the bytes for the host."""
        self._board.run(periods * PERIOD)
        return self._port.receive()

    def write(self, data: bytes) -> None:
        """Sends these bytes to the board."""
        self._port.write(data)

    def fault(self, device: str, kind: FaultKind) -> None:
        """Sets or clears the fault of a device."""
        self._board.fault(device, kind)

    def line(self, command: str) -> None:
        """Sets a fault of the line by a command such as `line to_board cut on`."""
        self._board.order(command)

    def seed_line(self, seed: int) -> None:
        """Seeds the faults of the line."""
        self._board.seed_line(seed)

    def reset(self) -> None:
        """Pull the reset pin."""
        self._board.reset()

    def close(self) -> None:
        """Ends the board."""
        self._port.close()
        self._board.close()
        self._process.stop()
        self._folder.cleanup()
