"""The story of recorded dives: segments, flags, figures against NumPy's, and tracks."""

import asyncio
from typing import Any

import numpy as np
import pytest
from sqlalchemy import insert

from robot_runtime.contract import documents
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents
from server.analysis.comparer import Comparer
from server.analysis.schemas import TimeRange
from server.analysis.segment import Segment
from server.analysis.story_schemas import Story
from server.platform.models import BookmarkRow
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.analysis.dives import (
    ARMED,
    DEEP,
    DISARMED,
    END,
    FLAPS,
    SHALLOW,
    START,
    STARTED_STEADY,
    STEPPED,
    depth_at,
    dive,
    record,
    rows,
    set_point_at,
)
from tests.server.blocks import DEPTH_LOOP, state_block

ORIGIN = STARTED_STEADY
RETUNED, BY_HAND = 118.0, 126.0
"""s, steady clock: other gains, and then a pilot."""


def mixed_dive() -> list[Block]:
    """Return the dive with other gains from RETUNED on, and without a controller from BY_HAND on."""
    blocks = [block for block in dive() if block.topic.name not in ("state", "event")]

    def chosen(kp: float) -> dict[str, Any]:
        gain = {"name": "kp", "value": kp, "minimum": 0, "maximum": 50, "unit": "", "meaning": ""}
        return {"controller": "pid", "controllers": [{"name": "pid", "title": "PID", "gains": [gain]}]}

    moments = [
        (START, "disarmed", 3.0, None),
        (ARMED + 0.04, "automatic", 3.0, None),
        (111.7, "automatic", 3.0, "yellow"),
        (RETUNED, "automatic", 4.0, "yellow"),
        (BY_HAND, "manual", 4.0, "yellow"),
        (DISARMED, "disarmed", 4.0, "yellow"),
    ]
    for number, (time, mode, kp, card) in enumerate(moments):
        armed = mode != "disarmed"
        loop = DEPTH_LOOP | chosen(kp)
        since = ARMED if armed else None
        blocks.append(
            state_block(number, time=time, mode=mode, armed=armed, armed_since=since, card=card, loops=[loop])
        )
    alarm = documents.Event(time=120.0, kind="depth_stale", severity="alarm", text="No depth.")
    step = documents.Event(time=STEPPED, kind="set_point", severity="info", text="Set point 1.00 m.")
    return [*blocks, Block.of(BY_NAME["event"], 2, 0, pack_documents([step, alarm]))]


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    return record(store, settings, mixed_dive())


def tell(store: Store, session: int) -> Story:
    return Comparer(store).stories.tell(session)


def settings_of(segment: Segment) -> tuple[str, str, dict[str, float], float | None]:
    return segment.mode, segment.title, segment.gains, segment.set_point


def test_segments_lie_between_changes(store: Store, session: int) -> None:
    segments = tell(store, session).segments
    edges = [ARMED, STEPPED, RETUNED, BY_HAND, DISARMED]
    starts, ends = (
        [segment.start + ORIGIN for segment in segments],
        [segment.end + ORIGIN for segment in segments],
    )
    assert starts == pytest.approx(edges[:-1])
    assert ends == pytest.approx(edges[1:])
    assert [settings_of(segment) for segment in segments] == [
        ("automatic", "PID", {"kp": 3.0}, SHALLOW),
        ("automatic", "PID", {"kp": 3.0}, DEEP),
        ("automatic", "PID", {"kp": 4.0}, DEEP),
        ("manual", "", {}, None),
    ]


def test_figures_of_each_segment_are_those_of_numpy(store: Store, session: int) -> None:
    comparer = Comparer(store)
    segments = comparer.stories.tell(session).segments
    figures = comparer.stories.measure(session, None)
    assert len(figures.segments) == len(segments)
    ticks = START + np.arange(round((END - START) * 50)) / 50
    for segment, measured in zip(segments, figures.segments, strict=True):
        values = {name: figure.value for name, figure in measured.items()}
        first, last = segment.start + ORIGIN, segment.end + ORIGIN
        inside = ticks[(ticks >= first - 1e-9) & (ticks < last - 1e-9)]
        depths = np.array([depth_at(time) for time in inside])
        assert values["duration"] == pytest.approx(last - first)
        # The board sends whole millimetres.
        assert values["deepest"] == pytest.approx(depths.max(), abs=5e-4)
        assert values["fin_strokes"] == pytest.approx(4 * FLAPS * (last - first), abs=4)
        assert values["alarms"] == (1 if segment.gains == {"kp": 4.0} else 0)
        if segment.holds_depth:
            errors = np.array([set_point_at(time) for time in inside]) - depths
            assert values["rmse"] == pytest.approx(np.sqrt(np.mean(errors**2)), abs=5e-4)
        else:
            assert values["rmse"] is None
            assert measured["rmse"].words == "No depth was held."


def test_the_whole_of_a_mixed_dive_has_no_figure_of_a_step(store: Store, session: int) -> None:
    whole = Comparer(store).stories.measure(session, None).whole
    assert whole["duration"].value == pytest.approx(DISARMED - ARMED)
    assert whole["overshoot"].value is None
    assert "see those of each" in whole["overshoot"].words
    ticks = np.arange(ARMED, BY_HAND, 0.02)
    errors = np.array([set_point_at(time) - depth_at(time) for time in ticks])
    assert whole["rmse"].value == pytest.approx(np.sqrt(np.mean(errors**2)), rel=1e-2)


def test_an_alarm_that_disarms_belongs_to_the_last_segment(store: Store, settings: Settings) -> None:
    blocks = [block for block in mixed_dive() if block.topic.name != "event"]
    alarm = documents.Event(time=DISARMED + 0.02, kind="leak", severity="alarm", text="Water inside.")
    number = record(store, settings, [*blocks, Block.of(BY_NAME["event"], 1, 0, pack_documents([alarm]))])
    figures = Comparer(store).stories.measure(number, None)
    assert [segment["alarms"].value for segment in figures.segments] == [0, 0, 0, 1]
    assert figures.whole["alarms"].value == 1


def test_a_chosen_part_has_figures_of_its_own(store: Store, session: int) -> None:
    part = TimeRange(start=STEPPED - ORIGIN, end=RETUNED - ORIGIN)
    stories = Comparer(store).stories
    chosen = stories.measure(session, part)
    assert chosen.segments == []
    assert chosen.whole == stories.measure(session, None).segments[1]
    by_hand = stories.measure(session, TimeRange(start=BY_HAND - ORIGIN, end=DISARMED - ORIGIN)).whole
    assert by_hand["rmse"].words == "No depth was held in this range."


def test_flags_are_what_happened_in_order_of_time(store: Store, session: int) -> None:
    values = {"session_id": session, "time": 105.0, "text": "bubbles\n\nmany of **them**", "made": 0.0}
    asyncio.run(store.write(lambda connection: connection.execute(insert(BookmarkRow).values(values))))
    flags = tell(store, session).flags
    assert [(flag.time + ORIGIN, flag.kind, flag.severity, flag.text) for flag in flags] == [
        (pytest.approx(105.0), "bookmark", "info", "bubbles"),
        (pytest.approx(111.7), "card", "info", "Yellow card"),
        (pytest.approx(STEPPED), "set_point", "info", "Set point 1.00 m."),
        (pytest.approx(RETUNED), "gains", "info", "PID: kp 3 → 4"),
        (pytest.approx(120.0), "alarm", "alarm", "No depth."),
    ]


def test_the_set_point_is_drawn_while_the_depth_is_held(store: Store, session: int) -> None:
    line = tell(store, session).set_point
    assert line is not None
    held = [time + ORIGIN for time, value in zip(line.time, line.low, strict=True) if value is not None]
    assert (min(held), max(held)) == (pytest.approx(ARMED, abs=0.1), pytest.approx(BY_HAND, abs=0.11))


def test_a_set_point_that_keeps_changing_is_one_segment(store: Store, settings: Settings) -> None:
    blocks = [block for block in dive() if block.topic.name != "control"]

    def ramp(time: float) -> documents.Control:
        value = SHALLOW + 0.1 * min(max(time - STEPPED, 0.0), 5.0)
        return documents.Control(set_point=value, depth=0.0, error=value, output=0.0, latency=0.01)

    number = record(store, settings, [*blocks, rows("control", 10.0, START, ramp)])
    segments = tell(store, number).segments
    assert [segment.set_point for segment in segments] == [SHALLOW, None, pytest.approx(1.0)]
    assert segments[1].end - segments[1].start == pytest.approx(5.0, abs=0.25)


def test_a_dive_that_was_never_armed_says_so(store: Store, settings: Settings) -> None:
    number = record(store, settings, dive(arms=False))
    story = tell(store, number)
    assert (story.segments, story.set_point) == ([], None)
    assert story.depth is not None
    figures = Comparer(store).stories.measure(number, None)
    assert figures.whole["rmse"].words == "The robot was never armed in this session."


def test_an_empty_session_has_an_empty_story(store: Store, settings: Settings) -> None:
    number = record(store, settings, [])
    story = tell(store, number)
    assert (story.depth, story.set_point, story.segments, story.flags) == (None, None, [], [])
    assert Comparer(store).stories.track(number) == []


def test_the_track_lies_beside_the_true_one(store: Store, settings: Settings) -> None:
    def track(time: float) -> documents.Track:
        since = max(time - ARMED, 0.0)
        return documents.Track(x=0.1 * since, y=0.0, deviation_x=0.01 * since, deviation_y=0.02 * since)

    def truth(time: float) -> documents.Truth:
        since = max(time - ARMED, 0.0)
        return documents.Truth(
            position=(7.0 + 0.12 * since, -3.0, depth_at(time)),
            attitude=(1.0, 0.0, 0.0, 0.0),
            velocity=(0.0, 0.0, 0.0),
            rate=(0.0, 0.0, 0.0),
            fins=(0.0, 0.0, 0.0, 0.0),
        )

    moves = [rows("track", 10.0, START, track), rows("truth", 50.0, START, truth)]
    (swum,) = Comparer(store).stories.track(record(store, settings, [*dive(), *moves]))
    lasted = DISARMED - ARMED
    assert swum.truth is not None
    assert (swum.estimate.x[0], swum.truth.x[0], swum.truth.y[0]) == pytest.approx((0, 0, 0), abs=1e-3)
    assert swum.estimate.x[-1] == pytest.approx(0.1 * lasted, abs=0.02)
    assert swum.truth.x[-1] == pytest.approx(0.12 * lasted, abs=0.02)
    assert swum.truth.depth[-1] == pytest.approx(DEEP, abs=1e-3)
    assert swum.deviation == pytest.approx((0.01 * lasted, 0.02 * lasted), abs=0.01)
    assert len(swum.estimate.time) <= 600
