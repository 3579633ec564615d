"""Looks for a command and a topic that were added to a copy of the sources, wherever they should be.

Run with the copy as the working directory; `test_one_contract` makes it.
"""

import asyncio
import tempfile
from pathlib import Path

import pytest

from robot_runtime.contract.chunks import describe_topics
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.topics import BY_NAME, SENT_BY
from robot_runtime.experiments.scenario.events import CommandEvent, read_event
from robot_runtime.generate.reference import commands_page, topics_page
from robot_runtime.generate.typescript import module
from server.app import create_app
from server.http.sign_in.policy import Need, list_needs
from server.platform.settings import DataFolder, Settings, make_folders
from tests.server.serving import Served, serve


def look_for_http_and_access() -> None:
    app = create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml")))
    document = app.openapi()
    operation = document["paths"]["/api/robot/commands/blink"]["post"]
    assert operation["summary"] == "Blinks the lamp"
    assert list_needs(app.routes)[operation["operationId"]] is Need.CONTROL
    field = document["components"]["schemas"]["BlinkCommand"]["properties"]["times"]
    assert (field["type"], field["minimum"], field["maximum"]) == ("integer", 1, 9)
    assert field["description"] == "flashes"


def look_for_scenario_event() -> None:
    where = DocumentEntry("event 1", ("events", 0))
    event = read_event({"do": "blink", "at": 2, "times": 3}, where)
    assert isinstance(event, CommandEvent)
    assert (event.do, event.label, event.command.payload()) == ("blink", "Blinks the lamp", {"times": 3})
    with pytest.raises(ConfigError, match=r"^event 1: times is 10; it must lie between 1 and 9$"):
        read_event({"do": "blink", "at": 2, "times": 10}, where)


def look_for_page_and_reference() -> None:
    assert "## blink\n\nBlinks the lamp." in commands_page()
    assert "- `times` (whole number, 1 to 9): flashes\n" in commands_page()
    assert "  lamp: {\n    id: 211,\n    name: 'lamp',\n" in module()
    assert "| [lamp](#lamp) | 211 | rows | simulator |  | light of the lamp |" in topics_page()


def look_for_topic() -> None:
    assert BY_NAME["lamp"] in SENT_BY["simulator"]
    assert describe_topics()["lamp"]["meaning"] == "light of the lamp"


async def look_for_undo(served: Served) -> None:
    served.runtime.answer = {"changed": {"lamp.flashes": [1, 3]}}
    refused = await served.api.post("/robot/commands/blink", json={"times": 10})
    assert refused.status_code == 422
    (await served.api.post("/robot/commands/blink", json={"times": 3})).raise_for_status()
    assert served.runtime.asked == [("blink", {"times": 3})]
    (change,) = (await served.api.get("/parameters/changes")).json()
    assert change["values"] == [{"name": "lamp.flashes", "before": 1, "after": 3}]
    (await served.api.post("/parameters/undo", json={"change": change["id"]})).raise_for_status()
    asked = {"values": {"lamp.flashes": 1}, "expected": {"lamp.flashes": 3}}
    assert served.runtime.asked[-1] == ("parameters", asked)


async def serve_and_undo() -> None:
    # A socket's path has to be short.
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = DataFolder(Path(name))
        make_folders(folder)
        async with serve(Settings(data=folder, config=Path("robot.toml"))) as served:
            await look_for_undo(served)


if __name__ == "__main__":
    look_for_http_and_access()
    look_for_scenario_event()
    look_for_page_and_reference()
    look_for_topic()
    asyncio.run(serve_and_undo())
