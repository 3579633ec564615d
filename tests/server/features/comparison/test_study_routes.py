"""Spectra and pairs over HTTP, and what is refused in words."""

import pytest

from server.platform.settings import Settings
from tests.server.serving import serve


async def test_spectra_and_pairs_of_a_part(settings: Settings, session: int) -> None:
    async with serve(settings) as served:
        asked: dict[str, list[str] | float] = {
            "signal": ["depth.depth", "control.set_point"],
            "from": 1,
            "to": 20,
        }
        first, second = (await served.api.get(f"/sessions/{session}/spectrum", params=asked)).json()
        assert (first["signal"]["unit"], second["signal"]["name"]) == ("m", "control.set_point")
        assert first["problem"] == ""
        assert len(first["frequency"]) == len(first["density"]) > 16
        assert first["peak"]["amplitude"] > 0
        short = asked | {"to": 1.2}
        (few, _) = (await served.api.get(f"/sessions/{session}/spectrum", params=short)).json()
        assert "a spectrum needs 32. Choose a longer range." in few["problem"]
        axes: dict[str, str | float] = {"x": "control.set_point", "y": "depth.depth", "from": 5, "to": 10}
        pairs = (await served.api.get(f"/sessions/{session}/pair", params=axes)).json()
        assert 5 <= pairs["time"][0] < pairs["time"][-1] <= 10
        assert len(pairs["time"]) == len(pairs["x_values"]) == len(pairs["y_values"])


@pytest.mark.parametrize(
    ("query", "status", "reason"),
    [
        ("spectrum?signal=depth.nothing", 404, "This session has no signal “depth.nothing”. Choose another."),
        ("spectrum?signal=x", 422, "signal"),
        ("spectrum", 422, "signal"),
        ("spectrum?" + "&".join(f"signal=depth.a{n}" for n in range(7)), 422, "at most 6"),
        ("pair?x=depth.depth&y=no.thing", 404, "no signal “no.thing”"),
        ("pair?x=depth.depth&y=depth.depth&from=5&to=5", 422, "must be after the start"),
    ],
)
async def test_what_cannot_be_studied_is_refused(
    settings: Settings, session: int, query: str, status: int, reason: str
) -> None:
    async with serve(settings) as served:
        answer = await served.api.get(f"/sessions/{session}/{query}")
        assert answer.status_code == status
        assert reason in answer.json()["detail"]
