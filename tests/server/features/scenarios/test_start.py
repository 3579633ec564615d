"""The start of a scenario over HTTP."""

import asyncio
import threading

import pytest

from robot_runtime.contract.limits import ConfigError
from server.features.scenarios import routes
from server.platform.settings import Settings
from tests.server.serving import serve


def test_a_scenario_is_not_read_in_the_event_loop(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    readers: list[int] = []

    def read_scenario(text: str) -> object:
        readers.append(threading.get_ident())
        raise ConfigError(text)

    monkeypatch.setattr(routes, "read_scenario", read_scenario)

    async def run() -> None:
        async with serve(settings) as served:
            start = {"text": "refused", "place": "simulated"}
            answer = await served.api.post("/scenarios/runs", json=start)
            assert (answer.status_code, answer.json()["detail"]) == (422, "refused")
            assert readers != []
            assert readers[0] != threading.get_ident()

    asyncio.run(run())
