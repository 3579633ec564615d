"""Some minutes of the load that `make hours` lets last an hour."""

import pytest

from tests.proofs.memory import LIMITS, measure
from tests.proofs.scales import ANONYMOUS, IN_USE, Limit, Scales, judge

LEAK = 300_000
"""bytes"""


# On a busy computer it takes minutes.
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("part", "minutes"), [("runtime", 3), ("server", 10)])
def test_memory_does_not_grow(part: str, minutes: int) -> None:
    held = measure(part, minutes)
    assert judge(LIMITS[part], held) == "", f"MB after each minute: {held}"


def test_growth_is_a_rise_beyond_noise_and_rate() -> None:
    limit = Limit(warm=2, noise=1.0, rate=0.1)
    assert limit.judge("it", [50, 90, 100, 100.9, 100, 100.9]) == ""
    assert limit.judge("it", [50, 90, 100, 100.5, 101, 101.5]) == (
        "it rose by 2.00 MB in 4 minutes; the limit is 1.40 MB"
    )
    assert limit.judge("it", [100, 100, 100]) == "it: 3 minutes do not show whether it grows; 2 warm it"


def test_each_kind_of_memory_has_its_limit() -> None:
    limits = {IN_USE: Limit(0, 0.1, 0), ANONYMOUS: Limit(0, 2, 0)}
    assert judge(limits, {IN_USE: [5, 5, 5], ANONYMOUS: [9, 9, 10]}) == ""
    assert "memory in use rose by 0.30 MB" in judge(limits, {IN_USE: [5, 5.1, 5.2], ANONYMOUS: [9, 9, 9]})
    assert "anonymous memory rose by 3.00 MB" in judge(limits, {IN_USE: [5, 5, 5], ANONYMOUS: [9, 10, 11]})


@pytest.mark.parametrize("size", [40, 5_000, LEAK])
def test_memory_in_use_rises_by_what_is_not_freed(size: int) -> None:
    scales = Scales()
    scales.weigh()
    leaked = [bytes(size) for _ in range(LEAK // size)]
    scales.weigh()
    leaked.clear()
    scales.weigh()
    before, leaking, freed = scales.held[IN_USE]
    assert 0.29 < leaking - before < 0.9
    assert abs(freed - before) < 0.05
