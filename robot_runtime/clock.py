"""The source of time: the computer's steady clock, or a simulated one that its owner advances."""

import time
from pathlib import Path
from typing import Protocol


class Clock(Protocol):
    """A source of time."""

    def now(self) -> float:
        """Return s of a steady clock, which never jumps and is the same in every process of one computer."""
        ...


class SteadyClock:
    """The computer's CLOCK_MONOTONIC, which all its processes share until it restarts."""

    def now(self) -> float:
        """Return s since an arbitrary moment, usually the start of the computer."""
        return time.monotonic()


def boot() -> str:
    """Return the identifier of this start of the computer; steady clocks compare only within one start."""
    return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()


class SimulatedClock:
    """A clock that advances only by `forward`."""

    def __init__(self, start: float = 0.0) -> None:
        self._now = start

    def now(self) -> float:
        """Return the start time and the seconds advanced since."""
        return self._now

    def forward(self, seconds: float) -> None:
        """Advance the time. Raise ValueError for a negative duration."""
        if seconds < 0:
            raise ValueError(f"time cannot run backwards by {-seconds} s")
        self._now += seconds
