"""Random missions end in their time, and take everything back. `make missions` swims more of them."""

from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.runtime.missions.mission_rig import TICK
from tests.runtime.missions.random_missions import STEPS, Swim, check_random_mission, write
from tests.runtime.missions.water import mission


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(STEPS, min_size=1, max_size=4), st.integers(0, 99))
def test_random_missions_end_in_their_time_and_take_everything_back(
    steps: list[dict[str, Any]], seed: int
) -> None:
    check_random_mission(steps, seed)


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(STEPS, min_size=1, max_size=4), st.integers(0, 99))
def test_the_same_mission_and_readings_give_the_same_documents(
    steps: list[dict[str, Any]], seed: int
) -> None:
    text = mission(*map(write, steps), limits="time = 3600")
    assert Swim(text, seed).documents == Swim(text, seed).documents


def test_it_ends_when_no_operators_page_is_open() -> None:
    text = mission("{ do = 'hold', seconds = 60, within = 5 }", limits="time = 100\nunwatched = 10")
    last = Swim(text, leave=5.0).documents[-1]
    assert (last.phase, last.text) == ("failed", "No operator's page was open for 10 s.")
    assert 15.0 <= last.elapsed <= 15.0 + 3 * TICK
    watched = Swim(text).documents[-1]
    assert watched.phase == "succeeded"
