"""The whole stack: a test on the robot's own board, here emulated, interrupted and completed."""

import json
from typing import Any

import pytest

from tests.server.waiting import alive
from tests.stack import Stack
from tests.waiting import SECONDS, wait_for

pytestmark = pytest.mark.stack

TEST: dict[str, Any] = {
    "id": 1,
    "name": "on the robot",
    "ino_path": "comm_test/comm_test.ino",
    "delay": [0.0],
    "baud_rate": [115200],
    "from_val": 1,
    "to_val": 21,
    "expected": 20,
    "arduinodelay": [0.0],
    "framing": "plain",
}
LONG = TEST | {"delay": [0.0, 10.0]}
"""Its second cell takes more than three minutes."""


def run(stack: Stack, *tests: dict[str, Any]) -> int:
    body = {"text": json.dumps(tests), "place": "robot"}
    answer = stack.api.post("/comm-tests/runs", json=body, timeout=SECONDS)
    assert answer.status_code == 201, answer.text
    number: int = answer.json()["run"]
    return number


def get(stack: Stack, number: int) -> dict[str, Any]:
    answer: dict[str, Any] = stack.api.get(f"/comm-tests/runs/{number}").json()
    return answer


def is_back(stack: Stack) -> bool:
    """Check that the robot's firmware answers the runtime, and is disarmed."""
    answer = stack.api.get("/robot")
    processes = {part["name"]: part["state"] for part in stack.api.get("/health").json()["parts"]}
    if (
        answer.status_code != 200
        or not processes["runtime"] == processes["link"] == processes["board"] == "ok"
    ):
        return False
    assert answer.json()["armed"] is False
    return answer.json()["connected"] is True


def test_after_a_kill_during_a_test_the_next_server_restores_the_firmware(shared_stack: Stack) -> None:
    stack = shared_stack
    away = stack.data / "firmware-away"
    number = run(stack, LONG)
    wait_for(lambda: get(stack, number)["cells_done"] == 1, "the first cell")
    assert away.exists()
    link = next(part for part in stack.api.get("/health").json()["parts"] if part["name"] == "link")
    assert (link["state"], "“on the robot”" in link["text"]) == ("absent", True)
    assert stack.api.post("/robot/commands/arm").status_code == 409
    assert stack.api.post("/sessions", json={}).status_code == 409
    comm_tests = stack.child("robot_runtime.experiments.comm_test")
    board = stack.part("board")
    stack.kill()
    wait_for(lambda: not alive(comm_tests.pid), "the test's process to end with its server")
    stack.wait_ready()
    assert alive(board.pid)
    wait_for(lambda: is_back(stack), "the robot")
    assert not away.exists()
    interrupted = get(stack, number)
    assert (interrupted["state"], interrupted["cells_done"]) == ("interrupted", 1)
    assert [cell["rate"] for cell in interrupted["results"]] == [1.0]

    number = run(stack, TEST)
    wait_for(lambda: get(stack, number)["state"] != "running", "the end")
    done = get(stack, number)
    assert (done["state"], done["problem"], done["place"]) == ("complete", "", "robot")
    wait_for(lambda: is_back(stack) and not away.exists(), "the robot")
