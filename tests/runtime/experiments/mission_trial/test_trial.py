"""Missions tried in simulated water: their scenario, and the outcome of a seed."""

from dataclasses import replace

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.missions import NO_LIMITS, MissionLimits
from robot_runtime.experiments.mission_trial.trial import TrialResult, trial_scenario, try_mission
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import Scenario
from tests.runtime.missions.water import DIVE, mission


def _scenario(text: str, seed: int = 1, limits: MissionLimits = NO_LIMITS) -> Scenario:
    return trial_scenario(text, {}, limits, seed, Craft())


def _swim(scenario: Scenario) -> TrialResult:
    return try_mission(scenario, boards()["host"])


def test_each_seed_has_its_own_heading_unless_the_trial_names_one() -> None:
    text = mission(DIVE) + "[trial]\nstart = { down = 0.5 }\n"
    first, second = (_scenario(text, seed).start for seed in (1, 2))
    assert first.down == second.down == 0.5
    assert first.heading != second.heading
    assert first.heading == _scenario(mission(DIVE)).start.heading
    assert _scenario(text.replace("down = 0.5", "heading = 1.0")).start.heading == 1.0


def test_no_page_need_be_open_in_simulated_time() -> None:
    text = mission("{ do = 'hold', seconds = 4, within = 9 }", limits="time = 50\nunwatched = 2")
    assert _swim(_scenario(text)).phase == "succeeded"
    bare = text.replace("unwatched = 2", "")
    assert _swim(_scenario(bare, limits=replace(NO_LIMITS, unwatched=2.0))).phase == "succeeded"


def test_a_limit_that_ends_it_is_no_steps_failure() -> None:
    unseen = "{ do = 'try', steps = [{ do = 'wait_for', sees = 'red', timeout = 1 }] }"
    result = _swim(_scenario(mission(unseen, DIVE, limits="depth = 0.6\ntime = 100")))
    assert (result.phase, result.failed) == ("failed", None)
    assert "below its limit of 0.6 m" in result.text


def test_a_mission_that_outlasts_its_trial_is_stopped_with_it() -> None:
    result = _swim(replace(_scenario(mission("{ do = 'hold', seconds = 60, within = 9 }")), duration=6.0))
    assert (result.phase, result.text) == ("ended", "The robot was stopped.")
    assert 0.0 < result.elapsed < 6.0
