"""Jumps of the wall clock: a robot without a battery-backed clock has no correct time before it is set."""

from math import inf

from robot_runtime.clock import Clock

DAY = 86_400.0
JUMP_SECONDS = 60.0
"""Difference between wall clock and steady clock that counts as a jump."""


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
