"""The missions of a session: document, last state, and when each step began."""

import pytest

from server.library import missions
from server.library.content import Recording
from server.library.missions import MISSIONS_SHOWN, read_missions
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.analysis.dives import STARTED_STEADY, dive, record, record_dive
from tests.server.library.missions import (
    DIVE_AT,
    MARK_AT,
    MISSION_END,
    REPEAT_AT,
    TEXT,
    mission_blocks,
)
from tests.server.new_database import new_store
from tests.server.serving import serve


def test_each_mission_is_told_with_its_document_end_and_starts(store: Store, settings: Settings) -> None:
    # A runtime that restarts counts from 1 again.
    session = record(store, settings, [*dive(), *mission_blocks(), *mission_blocks(shift=3.5)])
    (first, second), left_out = read_missions(Recording.open(store, session))
    assert left_out == 0
    assert (first.start, first.end) == (DIVE_AT - STARTED_STEADY, MISSION_END - STARTED_STEADY)
    assert (first.mission.phase, first.mission.text) == ("failed", "Step 2.1, mark: It was at 0.20 m.")
    assert (first.document, first.late) == (TEXT, False)
    assert {step.path: step.time + STARTED_STEADY for step in first.started} == {
        "": DIVE_AT,
        "1": DIVE_AT,
        "2": REPEAT_AT,
        "2.1": MARK_AT,
    }
    assert second.start == pytest.approx(first.start + 3.5)


def test_a_recording_that_begins_in_a_mission_says_so(store: Store, settings: Settings) -> None:
    session = record(store, settings, [*dive(), *mission_blocks(first=1)[:-1]])
    (mission,), _ = read_missions(Recording.open(store, session))
    assert (mission.late, mission.document, mission.mission.phase) == (True, "", "paused")
    assert read_missions(Recording.open(store, record(store, settings, dive()))) == ([], 0)


def test_an_answer_holds_the_first_missions_and_counts_the_others(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    count = MISSIONS_SHOWN + 3
    blocks = [block for number in range(count) for block in mission_blocks(number=number + 1)]
    recording = Recording.open(store, record(store, settings, [*dive(), *blocks]))
    shown, left_out = read_missions(recording)
    assert ([mission.mission.number for mission in shown], left_out) == ([*range(1, MISSIONS_SHOWN + 1)], 3)
    size = len(shown[0].model_dump_json())
    monkeypatch.setattr(missions, "SHOWN_BYTES", int(2.5 * size))
    shown, left_out = read_missions(recording)
    assert (len(shown), left_out) == (2, count - 2)


async def test_the_page_gets_the_missions_of_a_session(settings: Settings) -> None:
    with new_store(settings.data) as store:
        session = await record_dive(store, settings, [*dive(), *mission_blocks()])

    async with serve(settings) as served:
        answer = await served.api.get(f"/sessions/{session}/missions")
        assert answer.headers["Left-Out"] == "0"
        (mission,) = answer.json()
        assert mission["document"] == TEXT
        assert mission["mission"]["steps"][1]["note"] == "east"
        assert (await served.api.get("/sessions/999/missions")).status_code == 404
