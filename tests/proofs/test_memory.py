"""Some minutes of the load that `make hours` lets last an hour."""

import pytest

from tests.proofs.memory import LIMITS, Limit, measure


@pytest.mark.parametrize(("part", "minutes"), [("runtime", 3), ("server", 10)])
@pytest.mark.timeout(300)
def test_memory_does_not_grow(part: str, minutes: int) -> None:
    held = measure(part, minutes)
    assert LIMITS[part].judge(part, held) == "", f"MB after each minute: {held}"


def test_growth_is_a_rise_beyond_noise_and_rate() -> None:
    limit = Limit(warm=2, noise=1.0, rate=0.1)
    assert limit.judge("it", [50, 90, 100, 100.9, 100, 100.9]) == ""
    assert limit.judge("it", [50, 90, 100, 100.5, 101, 101.5]) == (
        "it: memory rose by 2.00 MB in 4 minutes; the limit is 1.40 MB"
    )
    assert limit.judge("it", [100, 100, 100]) == ("it: 3 minutes do not show whether memory grows; 2 warm it")
