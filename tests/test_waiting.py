"""Tests that wait leave the processor to what they wait for."""

import time

import pytest

from tests.waiting import wait_for

TAKEN = 0.01
"""s that a look takes, as a request to a server does"""


def test_looks_take_a_fifth_of_the_time_at_most() -> None:
    looks = 0

    def look() -> bool:
        nonlocal looks
        looks += 1
        time.sleep(TAKEN)
        return False

    with pytest.raises(AssertionError, match=r"waited 0\.5 s in vain for the end"):
        wait_for(look, "the end", 0.5)
    assert looks <= 0.5 / (5 * TAKEN) + 1
