"""Summaries: made once a recording has ended, beside the server; a session without a name gets one."""

from datetime import UTC, datetime
from typing import Any

import pytest

from server.features.comparison import summaries
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.library.catalogue import Catalogue
from server.platform.settings import Settings
from server.recording.session import default_name, has_default_name
from server.stream.hub import Hub
from tests.server.analysis.dives import dive, record
from tests.server.new_database import new_store
from tests.server.serving import Served
from tests.server.waiting import until


@pytest.fixture
def dives(settings: Settings) -> list[int]:
    """A dive that nobody named, and one that somebody did."""
    with new_store(settings.data) as store:
        return [record(store, settings, dive(), name=name) for name in ("", "mine")]


async def test_every_session_gets_a_summary_and_only_a_nameless_one_a_name(
    dives: list[int], served: Served
) -> None:
    worker = served.get(summaries.SummaryWorker)
    await worker.make_missing()
    named, nameless = (await served.api.get("/sessions")).json()
    assert (named["id"], named["name"], nameless["id"]) == (dives[1], "mine", dives[0])
    assert nameless["name"] == "1.0 m, PID, yellow card"
    for listed in (named, nameless):
        assert listed["summary"]["depth"] == pytest.approx(1.0, abs=0.01)
    matching = await served.api.get("/sessions", params={"controller": "PID", "search": "yellow"})
    assert [session["id"] for session in matching.json()] == [dives[0]]
    assert (await served.api.get("/sessions/controllers")).json() == ["PID"]


async def test_a_summary_is_made_when_a_recording_ends_and_pages_are_told(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(summaries, "TICK_SECONDS", 0.01)
    sent: list[dict[str, Any]] = []
    served.get(Hub).listeners.append(sent.append)
    session = (await served.api.post("/sessions", json={"name": "<b>&"})).json()
    await served.api.post(f"/sessions/{session['id']}/stop")
    await until(lambda: {"op": "summary", "session": session["id"]} in sent, "word of the summary")
    stored = served.get(Catalogue).find(session["id"])
    assert stored.summary is not None
    assert stored.name == "<b>&"


async def test_what_cannot_be_read_is_not_read_again(
    dives: list[int], served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    async def fail(_: ComparisonWorker, __: str, query: str) -> bytes:
        asked.append(query)
        raise ComparisonError("no process")

    monkeypatch.setattr(ComparisonWorker, "ask", fail)
    worker = served.get(summaries.SummaryWorker)
    await worker.make_missing()
    await worker.make_missing()
    assert asked == [str(number) for number in reversed(dives)]


async def test_a_name_of_a_megabyte_is_refused(dives: list[int], served: Served) -> None:
    answer = await served.api.patch(f"/sessions/{dives[1]}", json={"name": "x" * 1_000_000})
    assert answer.status_code == 413
    answer = await served.api.patch(f"/sessions/{dives[1]}", json={"name": "x" * 101})
    assert answer.status_code == 422
    assert served.get(Catalogue).find(dives[1]).name == "mine"


def test_a_default_name_is_of_the_moment_and_says_whether_it_was_armed() -> None:
    moment = datetime(2026, 5, 31, 10, 0, 2, tzinfo=UTC)
    assert default_name(moment, armed=True) == "Armed 2026-05-31 10:00 UTC"
    assert has_default_name("2026-05-31 10:00 UTC", moment)
    # It was made a moment before.
    assert has_default_name("Armed 2026-05-31 09:59 UTC", moment)
    assert not has_default_name("2026-05-30 10:00 UTC", moment)
