"""The host's end of the serial line in a communication test, emulated or real."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Self

from robot_runtime.experiments.comm_test.faults import Faults, TimedFault, order_both
from robot_runtime.experiments.comm_test.results import LineErrors

BITS_PER_BYTE = 10
WRITE_BUFFER_BYTES = 4000
"""A little less than Linux keeps for a serial port; a longer write waits for the line."""
TIME_MIN = 1e-6
"""s; the emulated board tells its time with six digits."""


class StoppedError(Exception):
    """The test was cancelled."""


class Cancellation:
    """A request to cancel a test. Signal handlers may set it.

    An Event would not do: a second signal may interrupt the handler of the first while that has its lock.
    """

    def __init__(self) -> None:
        self._set = False

    def set(self) -> None:
        """Request cancellation."""
        self._set = True

    def is_set(self) -> bool:
        """Return True if cancellation was requested."""
        return self._set


def check(stop: Cancellation) -> None:
    """Raise StoppedError once `stop` is set."""
    if stop.is_set():
        raise StoppedError("it was cancelled")


class CommTestLine(ABC):
    """A board with a sketch on it that has just been started, and its port open at `baud` (bit/s).

    `now` is the test's time in s, `written` and `heard` are what went over the port, `byte_time` is what a
    byte takes (s); `start_time` is how long the sketch takes until it listens (s). Every method raises
    BoardError or PortError where the board or the port goes away.
    """

    start_time: float

    def __init__(self, baud: int) -> None:
        self.byte_time = BITS_PER_BYTE / baud
        self.written = 0
        self.heard = b""
        self.now = 0.0
        self._line_free = 0.0
        self._airtime_factor = 1.0
        self._disturbed = False
        self._timed_faults: Iterator[TimedFault] = iter(())
        self._next_fault: TimedFault | None = None

    @abstractmethod
    def errors(self) -> LineErrors:
        """Return the known errors on the wire since the start."""

    @abstractmethod
    def close(self) -> None:
        """Close port and board."""

    @abstractmethod
    def _order(self, command: str) -> None:
        """Give the line a command for its faults."""

    @abstractmethod
    def _hand_over(self, data: bytes) -> None:
        """Write bytes to the port."""

    @abstractmethod
    def _pass(self, seconds: float) -> None:
        """Advance the time: set `now`, and add received bytes to `heard`. Raise StoppedError."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def busy(self) -> float:
        """The time (s) until the line has sent everything that was written."""
        return max(self._line_free - self.now, 0.0)

    def inject_faults(self, faults: Faults) -> None:
        """Inject these faults from now on."""
        if faults == Faults(seed=faults.seed):
            return
        self._disturbed = True
        faults.begin(self._order)
        self._airtime_factor = 1 + faults.double + faults.insert
        self._timed_faults = faults.timed(self.now)
        self._next_fault = next(self._timed_faults, None)

    def clear_faults(self) -> None:
        """Remove all faults from the line."""
        if self._disturbed:
            order_both(self._order, "clean")
        self._next_fault = None
        self._airtime_factor = 1.0

    def drain(self) -> None:
        """Wait until all written bytes have passed the line, which a stall may delay."""
        while self.busy > TIME_MIN:
            self.wait(self.busy)

    def write(self, data: bytes) -> None:
        """Write bytes to the port; wait for the line while its buffer is full."""
        room = WRITE_BUFFER_BYTES * self.byte_time
        airtime = len(data) * self.byte_time * self._airtime_factor
        while self.busy + airtime > room + TIME_MIN:
            self.wait(self.busy + airtime - room)
        self._hand_over(data)
        self._line_free = self.now + self.busy + airtime

    def wait(self, seconds: float) -> None:
        """Wait in test time and add received bytes to `heard`. Raise StoppedError."""
        end = self.now + seconds
        while end - self.now > TIME_MIN:
            pause = end if self._next_fault is None else min(end, self._next_fault[0])
            if pause - self.now > TIME_MIN:
                self._pass(pause - self.now)
            while self._next_fault is not None and self._next_fault[0] - self.now <= TIME_MIN:
                self._apply_fault(self._next_fault)
                self._next_fault = next(self._timed_faults, None)

    def _apply_fault(self, fault: TimedFault) -> None:
        _, kind, seconds = fault
        if kind == "stall":
            order_both(self._order, f"stall {seconds!r}")
            self._line_free = self.now + self.busy + seconds
        else:
            order_both(self._order, "cut on" if kind == "cut" else "cut off")
