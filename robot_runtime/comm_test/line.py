"""What a cell needs of the line on which it runs, be it emulated or real."""

from threading import Event
from typing import Protocol

from robot_runtime.comm_test.results import LineErrors


class StoppedError(Exception):
    """Somebody has asked that the test end before it is complete."""


def check(stop: Event) -> None:
    """Raises StoppedError once `stop` is set."""
    if stop.is_set():
        raise StoppedError("it was cancelled")


class Line(Protocol):
    """The host's end of a serial line. Times are s of test time: emulated, or as they pass.

    `now` is 0 when the line is opened, `written` and `heard` are what went over the port, `byte_time` is what
    a byte takes.
    """

    byte_time: float
    written: int
    heard: bytes

    @property
    def now(self) -> float:
        """Test time."""

    @property
    def busy(self) -> float:
        """s until everything that was written is through the line."""

    def write(self, data: bytes) -> None:
        """Hand bytes to the port."""

    def wait(self, seconds: float) -> None:
        """Let time pass, and read what comes meanwhile into `heard`. Raises StoppedError."""

    def errors(self) -> LineErrors:
        """What happened on the wire since the line was opened, as far as it can be known."""
