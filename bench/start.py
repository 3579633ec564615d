"""Time of a warm start of everything."""

import tempfile
import time
from pathlib import Path
from statistics import median

from tests.stack import Stack

_ROUNDS = 3


def measure() -> dict[str, float]:
    """s from the command until every part is well; the median of some starts."""
    return {"start.ready_s": median(_start() for _ in range(_ROUNDS))}


def _start() -> float:
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        with Stack(Path(folder)):
            return time.monotonic() - began
