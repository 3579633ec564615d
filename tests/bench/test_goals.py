"""Goals, scaled by how slow the machine is, and the verdicts of a run and of two commits."""

import pytest

from bench.against import verdict
from bench.goals import GOALS, Goal
from bench.parts import PARTS


def test_a_limit_in_time_grows_with_the_slowness_of_its_work() -> None:
    goal = Goal(8.0, is_least=False, work="drawing").scaled({"python": 3.0, "drawing": 1.5})
    assert goal.limit == 12.0
    assert goal.is_met(12.0)
    assert not goal.is_met(12.1)


def test_a_least_rate_falls_with_it() -> None:
    goal = Goal(30.0, is_least=True, work="python").scaled({"python": 2.0})
    assert goal.is_met(15.0)
    assert not goal.is_met(14.9)


def test_ratios_and_safety_are_the_same_on_every_machine() -> None:
    for name in ("hub.ratio_to_foxglove.50", "fault.line_cut_ms_max", "link.undetected_corruptions"):
        assert GOALS[name].scaled({"python": 4.0, "memory": 4.0, "drawing": 4.0}) == GOALS[name]


def test_parts_have_a_module_each() -> None:
    import importlib.util

    assert [name for name in PARTS if importlib.util.find_spec(f"bench.{name}") is None] == []


def test_each_long_part_has_goals_by_the_beginning_of_their_names() -> None:
    long = [part for part in PARTS.values() if part.is_long]
    assert long
    for part in long:
        assert part.prefix
        assert [name for name in GOALS if name.startswith(part.prefix)]


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ([10.0, 11.0, 12.0], [11.5, 12.0, 13.0], "no difference"),
        ([10.0, 11.0, 12.0], [13.0, 14.0, 15.0], "worse"),
        ([10.0, 11.0, 12.0], [7.0, 8.0, 9.0], "better"),
        ([10.00, 10.01], [10.02, 10.03], "no difference"),
        ([], [1.0], "new"),
    ],
)
def test_a_figure_differs_where_all_rounds_do(before: list[float], now: list[float], expected: str) -> None:
    assert verdict("page.redraw_ms", before, now) == expected


def test_without_a_goal_no_direction_is_better() -> None:
    assert verdict("rss.server_mb", [100.0, 101.0], [120.0, 121.0]) == "more"
