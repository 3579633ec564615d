"""A board whose time is advanced in steps, with simulated water at its sensors and a host at its port."""

from abc import ABC, abstractmethod
from typing import Self

from robot_runtime.simulation.boards.emulator_process import FaultKind

PERIOD = 0.005
"""s between two answers of the water; its fastest sensor is read every 10 ms."""


class SteppedBoard(ABC):
    """The robot's firmware on a board after power-on; ends with the `with` statement.

    At the end of each `PERIOD` the water gets the fins and returns the sensors' reading.
    """

    firmware: bytes
    """Contents of the program's file."""

    @abstractmethod
    def run(self, periods: int) -> bytes:
        """Advance by this many `PERIOD`s; return the bytes for the host, in order.

        Raise BoardError if the board ends.
        """

    @abstractmethod
    def write(self, data: bytes) -> None:
        """Send these bytes to the board, after those still queued."""

    @abstractmethod
    def fault(self, device: str, kind: FaultKind) -> None:
        """Set or clear the fault of a device (imu, pressure, encoder0-3, bridge0-3, leak).

        Raise BoardError.
        """

    @abstractmethod
    def mistake(self, text: str) -> None:
        """Add a mistake of `mistakes.MISTAKES` from now on. Raise BoardError."""

    @abstractmethod
    def line(self, command: str) -> None:
        """Set a fault of the line by a command such as `line to_board cut on`. Raise BoardError."""

    @abstractmethod
    def seed_line(self, seed: int) -> None:
        """Seed the faults of the line from now on."""

    @abstractmethod
    def reset(self) -> None:
        """Pull the reset pin."""

    @abstractmethod
    def close(self) -> None:
        """End the board."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
