"""Whole comparisons of recorded sessions, as the interface gives them."""

import asyncio
from dataclasses import replace
from typing import Any

import pytest
from sqlalchemy import insert

from server.analysis.comparer import Comparer
from server.analysis.definitions import FIGURES
from server.analysis.report import write_report
from server.analysis.schemas import Comparison, ComparisonQuery
from server.library.content import Recording
from server.platform.models import BookmarkRow, Gap
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.analysis.dives import (
    ARMED,
    DISARMED,
    FLAPS,
    SHOWN,
    STARTED_STEADY,
    STEPPED,
    WN,
    dive,
    record,
    record_dive,
)
from tests.server.blocks import debug_block
from tests.server.library.missions import DIVE_AT, MARK_AT, mission_blocks
from tests.server.new_database import new_store
from tests.server.serving import serve

DEPTH = ["depth.depth", "control.set_point"]
RISE = (3.889720 - 0.531812) / WN
"""s, see test_step_response."""


def compare(store: Store, *sessions: int, **request: Any) -> Comparison:
    values = {"sessions": list(sessions), "signals": DEPTH} | request
    return Comparer(store).compare(ComparisonQuery.model_validate(values))


def mark(store: Store, session: int, time: float, text: str) -> None:
    values = {"session_id": session, "time": time, "text": text, "made": 0.0}
    asyncio.run(store.write(lambda connection: connection.execute(insert(BookmarkRow).values(values))))


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    return record(store, settings, dive(), name="one")


def test_figures_of_a_known_dive(store: Store, session: int) -> None:
    (item,) = compare(store, session).sessions
    values = {name: figure.value for name, figure in item.figures.items()}
    assert list(values) == [meaning.name for meaning in FIGURES]
    assert values["rise_time"] == pytest.approx(RISE, abs=0.01)
    assert values["settling_time"] == pytest.approx(4.743865 / WN, abs=0.03)
    assert values["overshoot"] == 0
    assert values["steady_error"] == pytest.approx(0, abs=1e-3)
    assert values["cycle_amplitude"] is None
    assert values["cycle_period"] is None
    # The integral of ((1 + x) exp(-x))² from 0 on is 5/4; both steps are 0.5 m.
    mean = 2 * 0.5**2 * 1.25 / WN / (DISARMED - ARMED)
    assert values["rmse"] == pytest.approx(mean**0.5, rel=0.01)
    assert values["card_latency"] == pytest.approx(STEPPED - SHOWN, abs=1e-6)
    # The depth has moved 3 of 50 cm where 1 - (1 + x) exp(-x) is 0.06.
    assert values["motion_latency"] == pytest.approx(0.405 / WN, abs=0.02)
    assert values["fin_strokes"] == pytest.approx(4 * FLAPS * (DISARMED - ARMED), abs=4)
    assert values["effort"] == pytest.approx(50.0)
    assert (values["frames_lost"], values["gaps"]) == (0, 0)
    assert item.range == [(ARMED - STARTED_STEADY, DISARMED - STARTED_STEADY)]
    mark = item.figures["rise_time"].mark
    assert mark is not None
    assert (mark.low, mark.high) == (pytest.approx(0.05, abs=1e-3), pytest.approx(0.45, abs=1e-3))


def test_lines_alone_read_nothing_of_the_figures(
    store: Store, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []
    columns = Recording.columns

    def note(recording: Recording, topic: str, *others: Any) -> Any:
        read.append(topic)
        return columns(recording, topic, *others)

    monkeypatch.setattr(Recording, "columns", note)
    lines = compare(store, session, figures=False)
    assert {*read} == {"depth", "control"}
    whole = compare(store, session)
    assert {"motor", "link"} <= {*read}
    assert lines.sessions[0].figures == {}
    assert lines.sessions[0].series == whole.sessions[0].series
    assert lines.differences == whole.differences


def test_the_aligned_step_is_the_measured_one(store: Store, session: int) -> None:
    (first,) = compare(store, session, align={"by": "armed"}).sessions
    (second,) = compare(store, session, align={"by": "set_point"}).sessions
    assert first.figures["rise_time"].words.startswith("Step from 0.00 m to 0.50 m")
    assert second.figures["rise_time"].words.startswith("Step from 0.50 m to 1.00 m")
    assert second.figures["rise_time"].value == pytest.approx(RISE, abs=0.01)


def test_figures_come_from_the_chosen_range_only(store: Store, session: int) -> None:
    (item,) = compare(store, session, align={"by": "set_point"}, range={"start": -2.0, "end": 8.0}).sessions
    assert item.range == [pytest.approx((STEPPED - STARTED_STEADY - 2, STEPPED - STARTED_STEADY + 8))]
    assert item.figures["rise_time"].words.startswith("Step from 0.50 m to 1.00 m")
    assert item.figures["rmse"].value == pytest.approx((0.5**2 * 1.25 / WN / 10) ** 0.5, rel=0.01)
    assert item.figures["fin_strokes"].value == pytest.approx(4 * FLAPS * 10, abs=4)
    (calm,) = compare(store, session, align={"by": "set_point"}, range={"start": 10.0, "end": 15.0}).sessions
    assert calm.figures["rise_time"].value is None
    assert "no step" in calm.figures["rise_time"].words


def test_a_segment_of_each_session_has_the_figures_of_its_part(
    store: Store, settings: Settings, session: int
) -> None:
    # It begins armed, 3 s before the second step: its first segment is the end of a longer one.
    late = record(store, settings, dive(begin=STEPPED - 3.0), name="late", started=STEPPED - 3.5)
    query = {"over": "segment", "segments": [{"session": session, "segment": 2}]}
    chosen = compare(store, session, late, align={"by": "segment"}, **query)
    whole, tail = chosen.sessions
    assert [len(item.segments) for item in chosen.sessions] == [2, 2]
    assert (whole.segment, tail.segment) == (2, 2)
    assert (whole.offset, tail.offset) == (
        pytest.approx(STEPPED - STARTED_STEADY, abs=0.11),
        pytest.approx(3.5, abs=0.11),
    )
    assert chosen.likeness.alike
    # The integral of ((1 + x) exp(-x))² from 0 on is 5/4; the step is 0.5 m.
    mean = 0.5**2 * 1.25 / WN / (DISARMED - STEPPED)
    for item in chosen.sessions:
        assert item.figures["rmse"].value == pytest.approx(mean**0.5, rel=0.03)
        assert item.figures["rise_time"].value == pytest.approx(RISE, abs=0.01)
        assert item.figures["card_latency"].value is None
    alone = compare(store, session, over="segment", segments=[{"session": session, "segment": 1}])
    first = alone.sessions[0].figures
    mean = 0.5**2 * 1.25 / WN / (STEPPED - ARMED)
    assert first["rmse"].value == pytest.approx(mean**0.5, rel=0.03)


def test_a_session_without_the_chosen_segment_says_so(store: Store, settings: Settings, session: int) -> None:
    never = record(store, settings, dive(arms=False), name="never")
    chosen = [{"session": session, "segment": 3}]
    comparison = compare(store, session, never, align={"by": "segment"}, over="segment", segments=chosen)
    for item in comparison.sessions:
        assert (item.segment, item.offset) == (None, None)
        assert item.problem == "This session has no such segment."
        assert {figure.words for figure in item.figures.values()} == {item.problem}
    for wrong in ([*chosen, *chosen], [{"session": never + 1, "segment": 1}]):
        with pytest.raises(ValueError, match="Choose"):
            compare(store, session, never, segments=wrong)


def test_unlike_parts_have_no_better_value(store: Store, settings: Settings, session: int) -> None:
    like = record(store, settings, dive(gains={"kp": 6.0}), name="like")
    late = record(store, settings, dive(begin=STEPPED + 1.0), name="late", started=STEPPED + 0.5)
    never = record(store, settings, dive(arms=False), name="never")
    assert compare(store, session, like).likeness.alike
    why = compare(store, session, like, late).likeness.why
    assert "“one” has 2 segments, “late” has 1 segment. Choose a segment of each." in why
    assert "“never” was not armed in this part." in compare(store, session, never).likeness.why
    # Of both sessions the second segment alone.
    part = {"start": STEPPED - STARTED_STEADY + 1.0, "end": DISARMED - STARTED_STEADY}
    assert compare(store, session, like, range=part).likeness.alike


def test_losses_and_gaps_are_counted(store: Store, settings: Settings) -> None:
    session = record(store, settings, dive(lost=7))
    values = {"session_id": session, "topic": "depth", "kind": "missed", "time": ARMED + 1, "missed": 30}
    asyncio.run(store.write(lambda connection: connection.execute(insert(Gap).values(values))))
    (item,) = compare(store, session).sessions
    assert item.figures["frames_lost"].value == 7
    assert item.figures["gaps"].value == 1
    assert item.figures["gaps"].words == "Missing samples: 30 of depth."


def test_sessions_are_aligned_at_the_chosen_moment(store: Store, session: int) -> None:
    mark(store, session, 120.25, "Here it turned")
    moments = [
        ({"by": "start"}, 0.0),
        ({"by": "armed"}, ARMED - STARTED_STEADY),
        ({"by": "set_point", "number": 1}, STEPPED - STARTED_STEADY),
        ({"by": "marker", "marker": "here it turned "}, 120.25 - STARTED_STEADY),
    ]
    for align, offset in moments:
        (item,) = compare(store, session, align=align).sessions
        assert (item.offset, item.problem) == (pytest.approx(offset), ""), align
    assert item.markers[0].text == "Here it turned"
    assert [event.text for event in item.events] == ["Armed."]


def test_a_recording_that_begins_armed(store: Store, settings: Settings) -> None:
    """States give the time of arming even before the recording; earlier data is not measured."""
    for before, measured in ((0.2, True), (20.0, False)):
        started = ARMED + before
        number = record(store, settings, dive(begin=started), started=started)
        (result,) = compare(store, number, align={"by": "armed"}).sessions
        assert (result.offset, result.problem) == (pytest.approx(-before), "")
        assert result.armed[0][0] == pytest.approx(-before)
        assert (result.figures["rise_time"].value is not None) == measured


def test_a_session_without_the_moment_is_listed_with_the_reason(
    store: Store, settings: Settings, session: int
) -> None:
    never = record(store, settings, dive(arms=False), name="never")
    problems = {
        "armed": "The robot was never armed in this session.",
        "set_point": "The set point never changed while the robot was armed.",
        "marker": "This session has no bookmark “turn”.",
    }
    for by, text in problems.items():
        item = compare(store, never, align={"by": by, "marker": "turn"}).sessions[0]
        assert (item.offset, item.problem, item.series) == (None, text, {}), by
    both = compare(store, session, never, align={"by": "armed"})
    assert [bool(session.series) for session in both.sessions] == [True, False]
    assert both.sessions[1].figures["rise_time"].words == "The robot was never armed in this session."
    part = compare(store, never, align={"by": "armed"}, range={"start": 0, "end": 5}).sessions[0]
    assert {(figure.value, figure.words) for figure in part.figures.values()} == {(None, problems["armed"])}
    second = compare(store, session, align={"by": "set_point", "number": 2}).sessions[0]
    assert second.problem == (
        "The set point changed only once while the robot was armed, so there is no step 2."
    )


def test_a_step_of_a_mission_is_a_moment_too(store: Store, settings: Settings, session: int) -> None:
    swum = record(store, settings, [*dive(), *mission_blocks()], name="swum")
    for path, time in (("2.1", MARK_AT), ("", DIVE_AT)):
        first, other = compare(store, swum, session, align={"by": "mission", "step": path}).sessions
        assert (first.offset, first.problem) == (pytest.approx(time - STARTED_STEADY), "")
        assert other.problem == "No mission ran in this session."
    assert [(step.path, step.words) for step in first.mission_steps] == [
        ("", "Sequence"),
        ("1", "Dive to 0.6 m"),
        ("2", "Repeat 2 times"),
        ("2.1", "Mark “here”"),
    ]
    late = record(store, settings, [*dive(), *mission_blocks(first=1)])
    problems = [
        (swum, "3", "Step 3 of the mission “Look east” never began."),
        (swum, "7.1", "The mission “Look east” has no step 7.1."),
        (late, "1", "The mission “Look east” began before this recording."),
    ]
    for number, path, text in problems:
        (result,) = compare(store, number, align={"by": "mission", "step": path}).sessions
        assert (result.offset, result.problem, result.series) == (None, text, {})
    align = {"by": "mission", "step": "2.1"}
    assert "the start of the mission’s step 2.1" in write_report(compare(store, swum, align=align))


def test_differences_between_sessions_are_listed(store: Store, settings: Settings, session: int) -> None:
    other_settings = replace(settings, config_text='[robot]\nname = "tested"\n[control]\nrate = 20.0\n')
    other = record(store, other_settings, dive("pid", {"kp": 6.0}), name="other")
    differences = {
        (difference.group, difference.name): difference.values
        for difference in compare(store, session, other).differences
    }
    assert differences == {
        ("In force", "PID: kp"): ["3", "6"],
        ("robot.toml", "control.rate"): ["", "20"],
    }
    assert compare(store, session, session).sessions[0].id == session


def test_lines_exist_for_the_recorded_signals_only(store: Store, settings: Settings, session: int) -> None:
    bare = record(store, settings, [debug_block(0, "a")])
    both = compare(store, session, bare, signals=[*DEPTH, "state.set_point", "truth.position_2"], points=100)
    assert [signal.name for signal in both.signals] == [*DEPTH, "state.set_point"]
    assert both.signals[0].unit == "m"
    first, other = both.sessions
    assert other.series == {}
    line = first.series["depth.depth"]
    assert 95 <= len(line.time) <= 102
    assert line.time[0] == pytest.approx(0.5, abs=1e-3)
    assert max(high for high in line.high if high is not None) == pytest.approx(1.0, abs=1e-3)
    assert first.series["state.set_point"].high == [0.5] * 4


async def test_over_http(settings: Settings) -> None:
    with new_store(settings.data) as store:
        session = await record_dive(store, settings, dive(), name="one")

    async with serve(settings) as served:
        signals = (await served.api.get(f"/sessions/{session}/signals")).json()
        names = [signal["name"] for signal in signals]
        assert {"depth.depth", "control.set_point", "motor.angle_3", "state.set_point"} <= set(names)
        assert not any(name.startswith(("imu.", "truth.", "detection.")) for name in names)
        request = {"sessions": [session], "signals": DEPTH, "align": {"by": "armed"}, "points": 200}
        answer = await served.api.post("/compare", json=request)
        assert answer.status_code == 200
        whole = answer.json()["sessions"][0]
        assert whole["figures"]["rise_time"]["value"] == pytest.approx(RISE, abs=0.01)
        part = await served.api.post("/compare/lines", json=request | {"view": {"start": 0, "end": 2}})
        line = part.json()["sessions"][0]["series"]["depth.depth"]
        assert len(line["time"]) == pytest.approx(102, abs=2)
        assert line["time"][0] >= whole["offset"] - 0.03


BAD: list[tuple[dict[str, Any], int, str]] = [
    ({"sessions": [99], "signals": DEPTH}, 404, "There is no session 99"),
    ({"sessions": [], "signals": DEPTH}, 422, "sessions"),
    ({"sessions": [1] * 13, "signals": DEPTH}, 422, "sessions"),
    ({"sessions": [1], "signals": ["depth"]}, 422, "signals"),
    ({"sessions": [1], "signals": DEPTH, "align": {"by": "guess"}}, 422, "align"),
    ({"sessions": [1], "signals": DEPTH, "align": {"by": "mission", "step": "2.x"}}, 422, "step"),
    ({"sessions": [1], "signals": DEPTH, "points": 1}, 422, "points"),
    ({"sessions": [1], "signals": DEPTH, "colour": "red"}, 422, "colour"),
]


async def test_bad_questions_are_refused(settings: Settings) -> None:
    with new_store(settings.data) as store:
        await record_dive(store, settings, dive(), name="one")

    async with serve(settings) as served:
        for request, status, text in BAD:
            answer = await served.api.post("/compare", json=request)
            assert (answer.status_code, text in answer.json()["detail"]) == (status, True), answer.text
        answer = await served.api.get("/compare/report", params={"sessions": "1", "by": "guess"})
        assert (answer.status_code, "by" in answer.json()["detail"]) == (422, True)
        answer = await served.api.get("/compare/report", params={"sessions": "1,x"})
        assert answer.status_code == 422
        assert (await served.api.get("/sessions/99/signals")).status_code == 404
