"""A dive without Wi-Fi: the fins rest until the robot is wet, and the last document says that it came up."""

import pytest

from robot_runtime.control.node import Course
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.leaves.waiting import WET_FOR
from robot_runtime.missions.library import shipped_missions
from tests.runtime.experiments.scenario.staging import Output
from tests.runtime.missions.mission_rig import MissionRig
from tests.runtime.missions.test_documents import problems
from tests.runtime.missions.water import DIVE, HOLD, end_of, is_at_rest, mission, statuses, swim

WET = "{ do = 'wait_until_wet', timeout = 60 }"
PUSHED = 'at = 8; do = "trim"; buoyancy = 0.98; forward = 0.0; right = 0.0; above = 0.01'
LET_GO = 'at = 12; do = "trim"; buoyancy = 1.003; forward = 0.0; right = 0.0; above = 0.01'
"""A hand that pushes it under, and lets it go."""


def drives(report: Output, start: float, end: float) -> set[int]:
    """Return the drives that the fins had."""
    return {drive for motor in report.between("motor", start, end) for drive in motor.drive}


def commands(report: Output, start: float, end: float) -> set[tuple[float, ...]]:
    """Return the commands that the board was sent."""
    sent = report.between("navigation", start, end)
    return {(row.x, row.y, row.z, row.roll, row.pitch, row.yaw) for row in sent}


def test_it_begins_when_it_is_wet_and_says_that_it_came_up() -> None:
    report = swim(60, mission(WET, "{ do = 'wait', seconds = 3 }", DIVE, HOLD), PUSHED, LET_GO)
    documents = report.documents["mission"]
    wet = next(state["time"] for state in documents if statuses(state)["1"] == "done")
    depths = [sample.depth for sample in report.between("depth", wet - WET_FOR + 0.1, wet)]
    assert min(depths) > 0.08, "it was under water for so long"
    assert drives(report, 2.0, wet) == {0}, "not a fin moved on the bench"
    assert commands(report, 2.0, wet) == {(0.0,) * 6}
    ends = [state for state in documents if state["phase"] == "succeeded"]
    assert [state["surfaced"] is not None for state in ends] == [False, True]
    assert ends[0]["time"] < ends[1]["surfaced"] < ends[1]["time"]
    assert report.between("depth", ends[1]["surfaced"], 1e9)[0].depth < 0.11
    assert "The robot is at the surface." in report.texts("event")
    assert is_at_rest(report, ends[0]["time"] + 0.2)


def test_it_is_given_up_in_the_air_and_stopped() -> None:
    report = swim(15, mission("{ do = 'wait_until_wet', timeout = 6 }", DIVE))
    last = end_of(report)
    assert last["phase"] == "failed"
    assert all(state["surfaced"] is None for state in report.documents["mission"])
    assert last["text"] == "Step 1, wait until it is wet: It was not under water within 6 s."
    assert drives(report, 0.0, 15.0) == {0}
    assert report.documents["state"][-1]["mode"] == "disarmed"


def test_a_dip_is_no_immersion() -> None:
    rig = MissionRig()
    rig.prepare(mission(WET, HOLD))
    for depth in (0.0, 0.3, 0.0, 0.3, 0.0):
        rig.senses.measured = depth
        rig.tick(WET_FOR - 0.2)
    assert rig.last.phase == "running"
    assert rig.status("1") == "running"
    rig.senses.measured = 0.11
    rig.tick(WET_FOR + 0.3)
    assert rig.status("1") == "done"


def test_a_pause_on_the_bench_keeps_it_still() -> None:
    report = swim(
        14, mission(WET, DIVE), 'at = 4; do = "mission_pause"', 'at = 9; do = "mission_pause"; on = false'
    )
    assert any(state["phase"] == "paused" for state in report.documents["mission"])
    assert drives(report, 0.0, 14.0) == {0}


def test_a_wait_in_the_middle_lets_it_rise_and_the_dive_goes_on() -> None:
    report = swim(70, mission(DIVE, "{ do = 'wait', seconds = 15 }", DIVE))
    last = end_of(report)
    assert last["phase"] == "succeeded"
    steps = {step["path"]: step for step in last["steps"]}
    waited = next(state["time"] for state in report.documents["mission"] if statuses(state)["2"] == "done")
    rose = report.between("depth", waited - 15, waited)
    assert rose[-1].depth < rose[0].depth - 0.05
    assert steps["2"]["elapsed"] == pytest.approx(15.0, abs=0.2)
    assert commands(report, waited - 14.5, waited - 0.1) == {(0.0,) * 6}


def test_a_countdown_keeps_still_and_ends_with_its_time() -> None:
    rig = MissionRig()
    countdowns: list[float | None] = []
    override = rig.core.control.override_course

    def watch(course: Course | None) -> None:
        override(course)
        if course is not None:
            assert course.still
            countdowns.append(course.countdown)

    rig.core.control.override_course = watch  # type: ignore[method-assign]
    assert rig.swim(mission("{ do = 'count_down', seconds = 4 }")).phase == "succeeded"
    assert countdowns[:40] == pytest.approx([4.0 - 0.1 * tick for tick in range(40)])
    assert countdowns[-1] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("seconds", [2, 21])
def test_a_countdown_takes_3_to_20_s(seconds: int) -> None:
    assert problems(mission(f"{{ do = 'count_down', seconds = {seconds} }}")) == [
        f"step 1: seconds is {seconds}; it must lie between 3 and 20"
    ]


def test_the_first_dive_does_as_its_page_says() -> None:
    report = swim(90, shipped_missions()["first_dive"], PUSHED, LET_GO)
    last = end_of(report)
    assert last["phase"] == "succeeded"
    assert last["deepest"] < 0.8
    assert report.documents["mission"][-1]["surfaced"] is not None
    steps = {step["path"]: step for step in last["steps"]}
    assert steps["4"]["elapsed"] == pytest.approx(30.0, abs=0.2)


def test_its_limit_without_a_page_must_fit_the_dive() -> None:
    dive = (WET, DIVE, HOLD)
    read_mission(mission(*dive, limits="time = 200\nunwatched = 40"))
    short = problems(mission(*dive, limits="time = 200\nunwatched = 30"))
    assert short == [
        "limits.unwatched is 30 s: that long after the last page it would come up, and once it is wet the "
        "mission may take 39 s. Allow so much, here and in robot.toml ([missions] unwatched)"
    ]
    assert problems(mission(*dive), unwatched=30.0) == short
