"""The start of a scenario over HTTP."""

import threading

import pytest

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.control.craft_gains import craft_gains
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.simulation.water.parameters import SimulationParameters
from server.features.scenarios import routes
from server.features.scenarios.runs import ScenarioRunner
from server.platform.settings import Settings
from tests.server.serving import serve

ON_ITS_CRAFT = """
name = "own"
title = "On its own craft"
duration = 3
craft = "robot"
scene = { kind = "natural", depth = 2.0 }
"""


async def test_a_scenario_is_not_read_in_the_event_loop(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    readers: list[int] = []

    def read_scenario(text: str, _: Craft) -> object:
        readers.append(threading.get_ident())
        raise ConfigError(text)

    monkeypatch.setattr(routes, "read_scenario", read_scenario)

    async with serve(settings) as served:
        start = {"text": "refused", "place": "simulated"}
        answer = await served.api.post("/scenarios/runs", json=start)
        assert (answer.status_code, answer.json()["detail"]) == (422, "refused")
        assert readers != []
        assert readers[0] != threading.get_ident()


async def test_a_live_scenario_on_the_robots_craft_has_the_craft_in_force(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings.data.craft.write_text('title = "Heavy"\n[craft]\nbuoyancy = 1.003\nfin_drag = 0.22\n')
    started: list[Scenario] = []

    def start(scenario: Scenario, *_: object) -> str:
        started.append(scenario)
        return "0123456789abcdef"

    async with serve(settings) as served:
        await served.take_control()
        monkeypatch.setattr(served.get(ScenarioRunner), "start", start)
        answer = await served.api.post("/scenarios/runs", json={"text": ON_ITS_CRAFT, "place": "live"})
        assert answer.status_code == 201, answer.text
    (scenario,) = started
    craft = settings.read_craft()
    assert (scenario.robot, craft.buoyancy) == (SimulationParameters.of(craft), 1.003)
    assert scenario.control.gains["predictive"] == craft_gains(craft)
