"""Pauses before the restart of a process that has died."""

FIRST = 0.1
"""s, after the second death; after the first there is no pause."""
KILLED_MAX = 1.0
"""s, longest pause for a process that was killed."""
MAX = 5.0
"""s, longest pause for a process that ends by itself: it probably will again, and a start is costly."""
STEADY_SECONDS = 10.0
"""A process that ran this long is restarted without a pause."""


class Backoff:
    """Pauses that double from death to death, until a run lasts `STEADY_SECONDS`."""

    def __init__(self) -> None:
        self._next = 0.0

    def after(self, lived: float, *, killed: bool) -> float:
        """The pause in s after a run of `lived` s; `killed`: a signal ended it."""
        if lived >= STEADY_SECONDS:
            self._next = 0.0
        pause = min(self._next, KILLED_MAX) if killed else self._next
        self._next = min(max(2 * pause, FIRST), MAX)
        return pause


def describe_pause(pause: float) -> str:
    """The pause before a restart, in words."""
    return f"in {pause:.1f} s" if pause else "at once"
