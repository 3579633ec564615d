"""Waiting in a thread for conditions with a deadline."""

import time
from collections.abc import Callable

SECONDS = 240.0
"""More than anything takes on a busy computer: only what never happens fails. Beside robots in real time a
test takes up to twenty times as long as alone."""
_SHARE = 0.2
"""of the time that looks at a condition may take: what is waited for needs the processor, too"""
_PAUSES = 0.005, 0.1
"""s between two looks, least and most"""


def wait_for(condition: Callable[[], object], what: str = "it", seconds: float = SECONDS) -> float:
    """Wait until the condition holds; return the time. Fails with `what` when it never does."""
    begin = time.monotonic()
    end = begin + seconds
    while not condition():
        now = time.monotonic()
        assert now < end, f"waited {seconds:g} s in vain for {what}"
        time.sleep(pause(now - begin))
        begin = time.monotonic()
    return time.monotonic()


def pause(taken: float) -> float:
    """Return s until the next look at a condition, where the last one has taken this long (s)."""
    least, most = _PAUSES
    return min(max(least, taken * (1 / _SHARE - 1)), most)
