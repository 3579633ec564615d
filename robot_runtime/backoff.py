"""Pauses before the restart of a process that has died.

A process that dies by its own error probably will again, and a start is seconds of work for a Raspberry Pi's
only core: its pauses double up to `MAX`. So do those of a process that is killed before it has come up. A
process that had come up and was killed from outside works again as soon as it is started: its pause is short,
however often that happens, so that it is back within 2 s.
"""

from signal import SIGHUP, SIGINT, SIGKILL, SIGTERM

FIRST = 0.1
"""s, after the second death; after the first there is no pause."""
KILLED_MAX = 0.2
"""s, longest pause for a process that had come up and was killed. A start takes some 0.5 s; the rest of
the 2 s is for slow computers."""
MAX = 5.0
"""s, longest pause for all others."""
UP_SECONDS = 1.0
"""A process that ran this long had come up."""
STEADY_SECONDS = 10.0
"""A process that ran this long is restarted without a pause."""
_FROM_OUTSIDE = frozenset(-number for number in (SIGKILL, SIGTERM, SIGINT, SIGHUP))


def is_killed(status: int | None) -> bool:
    """Return True if this exit status is that of a process killed from outside, or is not known.

    Signals such as SIGSEGV and SIGABRT are errors of its own.
    """
    return status is None or status in _FROM_OUTSIDE


class Backoff:
    """Pauses that double from death to death, until a run lasts `STEADY_SECONDS`."""

    def __init__(self) -> None:
        self._next = 0.0

    def after(self, lived: float, *, killed: bool) -> float:
        """Return the pause, s, after a run of `lived` s; `killed`: from outside (`is_killed`)."""
        if lived >= STEADY_SECONDS:
            self._next = 0.0
        pause = min(self._next, KILLED_MAX) if killed and lived >= UP_SECONDS else self._next
        self._next = min(max(2 * pause, FIRST), MAX)
        return pause


def describe_pause(pause: float) -> str:
    """Return the pause before a restart, in words."""
    return f"in {pause:.1f} s" if pause else "at once"
