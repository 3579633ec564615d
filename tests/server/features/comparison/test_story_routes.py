"""The story over HTTP: in the process that compares, and refused at the edge in words."""

from contextlib import closing

import pytest
from sqlalchemy import text

from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.analysis.dives import DEEP, DISARMED, STARTED_STEADY, STEPPED
from tests.server.serving import serve

SETTLED = STEPPED + 15.0 - STARTED_STEADY


async def test_story_figures_track_and_readings(settings: Settings, session: int) -> None:
    async with serve(settings) as served:
        story = (await served.api.get(f"/sessions/{session}/story")).json()
        assert [segment["set_point"] for segment in story["segments"]] == [0.5, 1.0]
        assert [flag["text"] for flag in story["flags"]] == ["Armed.", "Yellow card"]
        figures = (await served.api.get(f"/sessions/{session}/story/figures")).json()
        assert len(figures["segments"]) == 2
        part = {"from": SETTLED, "to": SETTLED + 2.0}
        chosen = (await served.api.get(f"/sessions/{session}/story/figures", params=part)).json()
        assert chosen["segments"] == []
        assert chosen["whole"]["duration"]["value"] == pytest.approx(2.0)
        assert (await served.api.get(f"/sessions/{session}/track")).json() == []
        readings = await served.api.get(f"/sessions/{session}/readings", params={"time": SETTLED})
        values = readings.json()
        assert values["depth"] == pytest.approx(DEEP, abs=1e-3)
        assert values["set_point"] == pytest.approx(DEEP)
        assert len(values["fins"]) == 4
        assert values["heading"] is None
        after = {"time": DISARMED + 60 - STARTED_STEADY}
        late = (await served.api.get(f"/sessions/{session}/readings", params=after)).json()
        assert (late["depth"], late["fins"]) == (None, [])


@pytest.mark.parametrize(
    ("query", "reason"),
    [
        ("from=5&to=2", "The end, 2 s, must be after the start, 5 s."),
        ("from=5", "needs both its start and its end"),
        ("from=x&to=2", "from"),
        ("from=nan&to=2", "from"),
        ("form=1&to=2", "no query parameter 'form'"),
    ],
)
async def test_a_part_that_is_none_is_refused(
    settings: Settings, session: int, query: str, reason: str
) -> None:
    async with serve(settings) as served:
        answer = await served.api.get(f"/sessions/{session}/story/figures?{query}")
        assert answer.status_code == 422
        assert reason in answer.json()["detail"]


async def test_a_damaged_chunk_is_named(settings: Settings, session: int) -> None:
    with closing(Store(settings.data.database)) as store:
        await store.write(
            lambda connection: connection.execute(
                text("UPDATE chunk SET data = x'00' WHERE topic = 'depth' AND number = 0")
            )
        )
    async with serve(settings) as served:
        answer = await served.api.get(f"/sessions/{session}/story")
        assert answer.status_code >= 400
        assert "chunk 0 of depth is damaged" in answer.json()["detail"]


async def test_an_unknown_session_has_no_story(settings: Settings) -> None:
    async with serve(settings) as served:
        assert (await served.api.get("/sessions/77/story")).status_code == 404
