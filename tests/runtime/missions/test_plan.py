"""The plan of a mission: times and depths of its steps, against figures by hand and a simulated trial."""

from itertools import pairwise

import pytest

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.missions import NO_LIMITS
from robot_runtime.experiments.mission_trial.trial import CURVE_PERIOD, trial_scenario, try_mission
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.leaves.moving import STEADY, VERTICAL_SPEED
from robot_runtime.missions.library import SHIPPED, shipped_missions
from robot_runtime.missions.plan import STEPS_MAX, UNKNOWN_SECONDS, MissionPlan, PlannedStep, plan_mission
from tests.runtime.missions.water import mission

DIVE_SECONDS = 0.6 / VERTICAL_SPEED + STEADY
DIVE = "{ do = 'dive', depth = 0.6 }"
HOLD = "{ do = 'hold', seconds = 8 }"


def _plan(*steps: str) -> MissionPlan:
    return plan_mission(read_mission(mission(*steps, limits="time = 3600")))


def _spans(plan: MissionPlan) -> list[tuple[str, float, float]]:
    return [(step.path, round(step.start, 3), round(step.end, 3)) for step in plan.steps]


def test_steps_follow_each_other_in_time_and_depth() -> None:
    plan = _plan(DIVE, HOLD, "{ do = 'wait', seconds = 10 }", "{ do = 'surface' }")
    dive = round(DIVE_SECONDS, 3)
    assert _spans(plan) == [
        ("1", 0.0, dive),
        ("2", dive, dive + 8.0),
        ("3", dive + 8.0, dive + 18.0),
        ("4", dive + 18.0, dive + 18.0),
    ]
    # Still fins let it rise.
    assert [step.end_depth for step in plan.steps] == pytest.approx([0.6, 0.6, 0.3, 0.3])
    assert all(step.known for step in plan.steps)
    assert plan.complete


def test_a_step_whose_end_depends_on_what_happens_is_not_known() -> None:
    waits = "{ do = 'wait_for', sees = 'red', timeout = 60 }"
    asks = "{ do = 'is', sees = 'red' }"
    until = f"{{ do = 'until', timeout = 60, steps = [{asks}, {{ do = 'hold', seconds = 2 }}] }}"
    short = "{ do = 'wait_for', sees = 'red', timeout = 1 }"
    first, second, third = _plan(waits, until, short).steps
    assert (first.known, first.end - first.start) == (False, UNKNOWN_SECONDS)
    assert (second.path, second.known, second.end - second.start) == ("2.2", False, 2.0)
    assert third.end - third.start == pytest.approx(1.1)


def test_rounds_alternatives_and_conditions() -> None:
    rounds = f"{{ do = 'repeat', times = 3, steps = [{HOLD}] }}"
    choice = f"{{ do = 'first_of', steps = [{HOLD}, {DIVE}] }}"
    asked = "{ do = 'try', steps = [{ do = 'invert', steps = [{ do = 'is', below = 1 }] }] }"
    assert [path for path, *_ in _spans(_plan(rounds, choice, asked))] == ["1.1", "1.1", "1.1", "2.1"]


def test_steps_side_by_side_begin_together_and_a_race_ends_with_the_first() -> None:
    both = "{{ do = '{0}', steps = [{{ do = 'dive', depth = 3 }}, {{ do = 'swim', x = 0.5, seconds = 4 }}] }}"
    deep, swim, after = _plan(both.format("all"), HOLD).steps
    assert (deep.start, swim.start, swim.end) == (0.0, 0.0, 4.0)
    assert (after.start, after.start_depth) == (deep.end, 3.0)
    deep, swim, after = _plan(both.format("race"), HOLD).steps
    assert (deep.end, swim.end, after.start) == (4.0, 4.0, 4.0)
    assert after.start_depth == deep.end_depth == pytest.approx(3.0 * 4.0 / (3.0 / VERTICAL_SPEED + STEADY))


def test_a_plan_is_bounded() -> None:
    rounds = "{ do = 'repeat', times = 1000, steps = [{ do = 'hold', seconds = 1 }] }"
    plan = _plan(rounds)
    assert (len(plan.steps), plan.complete) == (STEPS_MAX, False)
    beside = f"{{ do = 'all', steps = [{rounds}, {{ do = 'turn', by = 1.0 }}] }}"
    assert len(_plan(beside).steps) == STEPS_MAX
    nothing = "{ do = 'invert', steps = [{ do = 'is', below = 1 }] }"
    empty = _plan(f"{{ do = 'repeat', times = 1000, steps = [{nothing}] }}")
    assert empty == MissionPlan(steps=[], complete=True)


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_missions_have_a_plan_without_jumps(name: str) -> None:
    texts = shipped_missions()
    steps = plan_mission(read_mission(texts[name], texts)).steps
    assert steps
    for before, after in pairwise(steps):
        assert after.start == pytest.approx(before.end)
        assert after.start_depth == pytest.approx(before.end_depth)


def test_the_plan_of_two_depths_is_what_happens_in_simulated_water() -> None:
    text = shipped_missions()["two_depths"]
    plan = plan_mission(read_mission(text)).steps
    result = try_mission(trial_scenario(text, {}, NO_LIMITS, 1, Craft()), boards()["host"])
    assert plan[-1].end == pytest.approx(result.elapsed, rel=0.1)
    for index, depth in enumerate(result.curve):
        # The limit cycle of the fins is ±0.1 m, and the start takes half a second.
        assert abs(_depth(plan, index * CURVE_PERIOD) - depth) < 0.2


def _depth(plan: list[PlannedStep], time: float) -> float:
    step = next((step for step in plan if step.start <= time <= step.end), plan[-1])
    share = (time - step.start) / (step.end - step.start) if step.end > step.start else 1.0
    return step.start_depth + min(share, 1.0) * (step.end_depth - step.start_depth)
