from collections.abc import Iterator
from signal import SIGABRT, SIGBUS, SIGHUP, SIGINT, SIGKILL, SIGSEGV, SIGTERM

import pytest

from robot_runtime.backoff import KILLED_MAX, MAX, Backoff, is_killed
from robot_runtime.clock import SimulatedClock

START = 0.5
"""s of work that a start costs."""


def starts(clock: SimulatedClock, life: float, *, killed: bool, seconds: float) -> Iterator[float]:
    """Yield the pauses before the starts of a process that dies after `life` s each time, for `seconds`."""
    backoff, end = Backoff(), clock.now() + seconds
    while clock.now() < end:
        clock.forward(life)
        pause = backoff.after(life, killed=killed)
        clock.forward(pause)
        yield pause


@pytest.mark.parametrize("life", [1.0, 1.5, 3.0, 9.9, 60.0])
def test_the_pause_after_a_kill_of_a_started_process_is_short(life: float) -> None:
    pauses = list(starts(SimulatedClock(), life, killed=True, seconds=1000 * life))
    assert len(pauses) > 800
    assert max(pauses) <= KILLED_MAX <= 2.0 - 3 * START


@pytest.mark.parametrize("killed", [False, True], ids=["by its own error", "killed while it starts"])
def test_pauses_of_a_process_that_dies_at_its_start_leave_the_processor_to_others(killed: bool) -> None:
    pauses = list(starts(SimulatedClock(), START, killed=killed, seconds=600))
    assert pauses[:7] == [0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2]
    assert set(pauses[7:]) == {MAX}
    assert len(pauses) * START < 0.1 * 600


def test_pauses_after_own_errors_are_long_until_a_steady_run() -> None:
    assert max(starts(SimulatedClock(), 3.0, killed=False, seconds=600)) == MAX
    assert max(starts(SimulatedClock(), 10.0, killed=False, seconds=600)) == 0


def test_a_kill_of_a_started_process_ends_the_long_pauses() -> None:
    backoff = Backoff()
    for _ in range(10):
        backoff.after(0.0, killed=False)
    assert backoff.after(1.0, killed=True) == KILLED_MAX
    assert backoff.after(0.0, killed=False) == 2 * KILLED_MAX


def test_signals_from_outside_are_kills_and_those_of_own_errors_are_not() -> None:
    assert all(is_killed(-number) for number in (SIGKILL, SIGTERM, SIGINT, SIGHUP))
    assert is_killed(None)
    assert not any(is_killed(-number) for number in (SIGSEGV, SIGABRT, SIGBUS))
    assert not is_killed(0)
    assert not is_killed(1)
