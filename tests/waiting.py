"""Waiting in a thread for conditions with a deadline."""

import time
from collections.abc import Callable

SECONDS = 240.0
"""More than anything takes on a busy computer: only what never happens fails. Beside robots in real time a
test takes up to twenty times as long as alone."""


def wait_for(condition: Callable[[], object], what: str = "it", seconds: float = SECONDS) -> float:
    """Wait until the condition holds; return the time. Fails with `what` when it never does."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited {seconds:g} s in vain for {what}"
        time.sleep(0.005)
    return time.monotonic()
