"""A board whose time passes only when it is told to, with the water at its sensors and a host at its port."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Self

from robot_runtime.simulation.boards.emulator_process import FaultKind
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

PERIOD = 0.005
"""s between two answers of the water; its fastest sensor is read every 10 ms."""

Water = Callable[[FinMotion], Reading]


class SteppedBoard(ABC):
    """The robot's firmware on a board just powered; ends with the `with` statement.

    At the end of each `PERIOD` the water is told of the fins and says what the sensors feel.
    """

    firmware: bytes
    """The file that holds the program."""

    @abstractmethod
    def run(self, periods: int) -> bytes:
        """Let this many `PERIOD`s pass; what came for the host in them, in order.

        Raises BoardError where the board goes away.
        """

    @abstractmethod
    def write(self, data: bytes) -> None:
        """Put these bytes on the line, after what still waits there."""

    @abstractmethod
    def fault(self, device: str, kind: FaultKind) -> None:
        """Break a device (imu, pressure, encoder0-3, bridge0-3), or mend it. Raises BoardError."""

    @abstractmethod
    def line(self, command: str) -> None:
        """Disturb the line by a command such as `line to_board cut on`. Raises BoardError."""

    @abstractmethod
    def seed_line(self, seed: int) -> None:
        """Let all that befalls the line from now on follow from this number."""

    @abstractmethod
    def reset(self) -> None:
        """Pull the reset pin."""

    @abstractmethod
    def close(self) -> None:
        """End it."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
