"""A short version of `make kills`."""

import pytest

from tests.proofs.kills import measure


@pytest.mark.timeout(300)
def test_a_server_that_is_killed_leaves_no_hole() -> None:
    report = measure(3, seed=4)
    assert not report.problems, report.table()
    assert report.rows > 0
