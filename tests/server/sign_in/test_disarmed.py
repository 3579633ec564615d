"""Uploads and builds are refused while the robot is armed."""

import json
from functools import partial
from typing import Any

from server.health.monitor import HealthMonitor
from tests.server.blocks import state_block
from tests.server.serving import Served
from tests.server.waiting import until
from tests.waiting import SECONDS

ENDLESS: dict[str, Any] = {
    "id": 1,
    "name": "endless",
    "ino_path": "comm_test/comm_test.ino",
    "delay": [10.0],
    "baud_rate": [9600],
    "from_val": 0,
    "to_val": 5000,
    "expected": 5000,
    "arduinodelay": [0.0],
}


async def answers(served: Served) -> list[tuple[int, str]]:
    """Statuses of an invalid upload and an invalid communication test."""
    given = [
        await served.api.post("/imports", content=b"no archive", timeout=SECONDS),
        await served.api.post("/comm-tests/runs", json={"text": "no document", "place": "emulated"}),
    ]
    return [(answer.status_code, answer.json()["detail"]) for answer in given]


def says(served: Served, armed: bool) -> bool:
    """Return True where the newest state has this value of `armed`."""
    state = served.get(HealthMonitor).state()
    return state is not None and state["armed"] is armed


async def test_an_armed_robot_refuses_uploads_and_builds(served: Served) -> None:
    for number, (armed, status) in enumerate(((True, 409), (False, 422))):
        served.runtime.publish(state_block(number, armed=armed))
        await until(partial(says, served, armed), "the state")
        for code, detail in await answers(served):
            assert (code, "while the robot is armed" in detail) == (status, armed)


async def test_an_armed_robot_keeps_its_firmware(served: Served) -> None:
    for number, armed in enumerate((True, False)):
        served.runtime.publish(state_block(number, armed=armed))
        await until(partial(says, served, armed), "the state")
        answer = await served.api.post("/firmware", json={"firmware": "previous"})
        assert (answer.status_code, "press STOP first" in answer.json()["detail"]) == (409, armed)


async def test_a_test_of_more_than_a_day_is_refused(served: Served) -> None:
    text = json.dumps([ENDLESS, ENDLESS])
    refused = await served.api.post("/comm-tests/runs", json={"text": text, "place": "emulated"})
    assert (refused.status_code, "28 hours" in refused.json()["detail"]) == (422, True)
    checked = (await served.api.post("/comm-tests/check", json={"text": text})).json()
    (problem,) = checked["problems"]
    assert (problem["path"], "at most 24" in problem["text"]) == ([], True)
    alone = (await served.api.post("/comm-tests/check", json={"text": json.dumps([ENDLESS])})).json()
    assert alone["problems"] == []
