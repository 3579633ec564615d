"""Time, as one injected thing: the computer's steady clock, or one that a test pushes forward."""

import time
from pathlib import Path
from typing import Protocol


class Clock(Protocol):
    """Where time comes from."""

    def now(self) -> float:
        """Seconds on a steady clock that never jumps; the same for every process of one computer."""
        ...


class SteadyClock:
    """The computer's own (CLOCK_MONOTONIC), shared by all its processes until it restarts."""

    def now(self) -> float:
        """Seconds since an arbitrary moment, usually the start of the computer."""
        return time.monotonic()


def boot() -> str:
    """Tells this start of the computer from others: the steady clocks of two cannot be compared."""
    return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()


class SimulatedClock:
    """Stands still until it is pushed."""

    def __init__(self, start: float = 0.0) -> None:
        self._now = start

    def now(self) -> float:
        """Seconds since the start that was given, as far as it was pushed."""
        return self._now

    def forward(self, seconds: float) -> None:
        """Advances the time. Raises ValueError for a negative duration."""
        if seconds < 0:
            raise ValueError(f"time cannot run backwards by {-seconds} s")
        self._now += seconds
