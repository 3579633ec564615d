"""A short version of `make soak`'s resets."""

from collections.abc import Sequence

import pytest

from tests.proofs.resets import Reset, measure, prepare


@pytest.mark.parametrize(
    ("program", "kinds", "resets"),
    [("robot", ("host",), 7), ("robot", ("reset pin", "power"), 8), ("robot_hang", ("watchdog",), 5)],
)
def test_the_session_recovers_without_duplicates(program: str, kinds: Sequence[Reset], resets: int) -> None:
    prepare()
    report = measure(program, kinds, resets, seed=11)
    assert not report.problems, report.table()
    assert report.resets.total() >= resets
    # Without noise a session is back with the next STATUS but one.
    assert all(recovery.seconds < 0.2 for recovery in report.returns if not recovery.noisy)
