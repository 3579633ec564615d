"""Pauses before a process that has died is started again."""

FIRST = 0.1
"""s after the second death; after the first there is nothing to wait for."""
KILLED_MAX = 1.0
"""s, at most, for what was killed."""
MAX = 5.0
"""s, at most, for what ends by itself: it will probably do so again, and each start costs much."""
STEADY_SECONDS = 10.0
"""What lived this long is started again at once when it ends."""


class Backoff:
    """Longer from death to death, for as long as they follow each other quickly."""

    def __init__(self) -> None:
        self._next = 0.0

    def after(self, lived: float, *, killed: bool) -> float:
        """s to wait after a life of `lived` s; `killed`: a signal ended it."""
        if lived >= STEADY_SECONDS:
            self._next = 0.0
        pause = min(self._next, KILLED_MAX) if killed else self._next
        self._next = min(max(2 * pause, FIRST), MAX)
        return pause


def describe_pause(pause: float) -> str:
    """When it is started again, in words."""
    return f"in {pause:.1f} s" if pause else "at once"
