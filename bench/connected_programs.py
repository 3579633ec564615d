"""The interface of measured programs at a door."""

from contextlib import AbstractContextManager
from time import monotonic, time
from typing import Protocol

END_SECONDS = 5.0
"""s for what is left in the buffers of a connection that the server has ended."""


class ConnectedPrograms(Protocol):
    """Programs at a door, which read everything."""

    def begin(self) -> None:
        """Count from now on."""

    def end(self) -> tuple[list[float], float]:
        """Return the delay of each message of the first program since `begin`, s, and the number of all.

        Raise ConnectionError where one was disconnected.
        """


class ProgramDoor(Protocol):
    """A door of a server that runs."""

    def programs(self, many: int) -> AbstractContextManager[ConnectedPrograms]:
        """Return so many programs, which subscribe to attitude and depth."""

    def stalled(self) -> AbstractContextManager[None]:
        """Return another program, which subscribes to more and reads nothing.

        Raise ConnectionError where it is not disconnected.
        """


def steady_time(utc: float) -> float:
    """Return a moment of UTC on the steady clock, s."""
    return utc - time() + monotonic()
