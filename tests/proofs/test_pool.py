"""The end of a pool of processes."""

import time
from contextlib import suppress
from pathlib import Path

from tests.proofs.pool import processes
from tests.waiting import SECONDS

WORKERS, TASKS = 2, 12


def _await(signal: Path) -> bool:
    """Return True once there is this file."""
    end = time.monotonic() + SECONDS
    while not signal.exists() and time.monotonic() < end:
        time.sleep(0.01)
    return signal.exists()


def test_what_has_not_begun_is_cancelled_by_an_interruption(tmp_path: Path) -> None:
    signal = tmp_path / "go on"
    with suppress(KeyboardInterrupt), processes(WORKERS) as pool:
        tasks = [pool.submit(_await, signal) for _ in range(TASKS)]
        tasks[-1].add_done_callback(lambda _: signal.touch())
        raise KeyboardInterrupt
    # Each worker may have one, and one more than there are workers may be on its way to them.
    assert sum(task.cancelled() for task in tasks) >= TASKS - WORKERS - (WORKERS + 1)
    assert all(task.cancelled() or task.result() for task in tasks)
