"""Summaries of sessions, and the names that they get from them."""

import asyncio

import pytest
from sqlalchemy import text

from robot_runtime.contract import documents
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents
from server.analysis.session_name import name_from
from server.analysis.session_reader import SessionReader
from server.analysis.summary import summarise
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.schemas import CURVE_POINTS, SessionSummary
from tests.server.analysis.dives import ARMED, DISARMED, END, SHOWN, STARTED_STEADY, depth_at, dive, record
from tests.server.blocks import film_block, thumbnail_block


def events(*severities: documents.Severity) -> Block:
    """Return events of these severities."""
    made = [
        documents.Event(time=ARMED, kind="anything", severity=severity, text="") for severity in severities
    ]
    return Block.of(BY_NAME["event"], len(made), 1, pack_documents(made))


def summarised(store: Store, settings: Settings, blocks: list[Block]) -> SessionSummary:
    """Return the summary of a session of these blocks."""
    return summarise(SessionReader(store), record(store, settings, blocks))


def test_a_summary_says_how_deep_how_long_by_what_and_what_was_seen(store: Store, settings: Settings) -> None:
    pictures = [thumbnail_block(number, time, b"jpeg") for number, time in enumerate((101.0, 120.0))]
    summary = summarised(store, settings, [*dive(), events("info", "alarm", "alarm"), *pictures])
    assert summary.depth == pytest.approx(depth_at(END), abs=0.001)
    assert summary.armed == pytest.approx(DISARMED - ARMED)
    assert (summary.controllers, summary.cards, summary.alarms) == (["PID"], ["yellow"], 2)
    assert summary.face == pytest.approx(SHOWN - STARTED_STEADY, abs=0.002)
    assert not summary.damaged
    length = END - STARTED_STEADY
    expected = [depth_at(STARTED_STEADY + (part + 1) * length / CURVE_POINTS) for part in range(CURVE_POINTS)]
    # The last of each part is the deepest; a sample may be missing at its end.
    assert summary.curve == pytest.approx(expected, abs=0.03)


def test_a_session_without_small_pictures_has_its_face_from_the_film(
    store: Store, settings: Settings
) -> None:
    film = [film_block(number, time, b"picture") for number, time in enumerate((101.0, 105.0))]
    assert summarised(store, settings, [*dive(), *film]).face == pytest.approx(105.0 - STARTED_STEADY)


def test_a_session_without_depth_pictures_and_arming_has_nothing_to_say(
    store: Store, settings: Settings
) -> None:
    summary = summarised(store, settings, [])
    assert (summary.depth, summary.face, summary.curve, summary.damaged) == (None, None, [], False)
    assert name_from(summary) == ""


def test_damaged_chunks_cost_what_they_hold_alone(store: Store, settings: Settings) -> None:
    session = record(store, settings, dive())
    damage = text("UPDATE chunk SET data = x'00' WHERE topic = 'depth'")
    asyncio.run(store.write(lambda connection: connection.execute(damage)))
    summary = summarise(SessionReader(store), session)
    assert (summary.damaged, summary.depth, summary.controllers) == (True, None, ["PID"])


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({}, "1.1 m, bang-bang and PID, yellow card"),
        ({"depth": None, "cards": []}, "bang-bang and PID"),
        ({"controllers": [], "cards": [], "modes": ["manual"]}, "1.1 m, by hand"),
        (
            {"depth": 0.01, "controllers": ["PID"], "cards": ["red", "blue", "green"]},
            "PID, red, blue and green cards",
        ),
        ({"controllers": ["Own " * 60]}, ("1.1 m, own " + "Own " * 60)[:100]),
        ({"armed": 0.0}, ""),
    ],
)
def test_a_name_tells(changes: dict[str, object], name: str) -> None:
    summary = SessionSummary(
        depth=1.12,
        armed=20.0,
        controllers=["Bang-bang", "PID"],
        modes=["automatic"],
        cards=["yellow"],
        mission="",
        alarms=0,
        curve=[],
        face=None,
        damaged=False,
    )
    assert name_from(summary.model_copy(update=changes)) == name
