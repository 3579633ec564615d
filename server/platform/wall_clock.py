"""Jumps of the wall clock: a robot without a battery-backed clock has no correct time before it is set."""

import ctypes
import time
from math import inf

from robot_runtime.clock import Clock

DAY = 86_400.0
SOFTWARE_MADE = 1_760_000_000
"""s since 1970, October 2025; a clock before that has not been set since the computer started."""
TIME_ERROR = 5
"""Answer of adjtimex(2) while the clock is not synchronised."""
TIMEX_BYTES = 512
"""At least the size of `struct timex` on every architecture."""
JUMP_SECONDS = 60.0
"""Difference between wall clock and steady clock that counts as a jump."""


def is_set(utc: float) -> bool:
    """True for a time (UTC, s since 1970) that this software can have seen."""
    return utc >= SOFTWARE_MADE


def is_synchronised() -> bool:
    """True where the kernel says so; asking for it needs no right (adjtimex(2) without a mode)."""
    state = int(ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(TIMEX_BYTES)))
    return 0 <= state < TIME_ERROR


def was_suspended() -> bool:
    """True where the computer has been suspended since its start: the steady clock stood still meanwhile."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.monotonic() > 1.0


class WallClock:
    """Compares the wall clock with the steady one; for a day after a jump no age is known.

    `ahead` is by how many s the wall clock was ahead of the steady one; None before the first comparison.
    """

    def __init__(self, clock: Clock) -> None:
        self.ahead: float | None = None
        self._clock = clock
        self._ages_known_from = -inf

    def knows_ages(self, now: float) -> bool:
        """True where ages can be told at this time (UTC, s since 1970)."""
        steady = self._clock.now()
        if self.ahead is not None and abs(now - steady - self.ahead) > JUMP_SECONDS:
            self._ages_known_from = steady + DAY
        self.ahead = now - steady
        return steady >= self._ages_known_from
