"""`python -m tests.in_the_loop DATA`: a robot on one host and its simulator on another; prints JSON.

The robot's board computes its fins; the network between the hosts delays, jitters, loses, and is cut for a
while.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.transport.blocks import read_blocks, read_rows
from server.library.replay import RANGE_MAX
from tests.exports import export_session
from tests.stack import ROOT, Stack
from tests.two_hosts import HERE, TwoHosts
from tests.waiting import SECONDS

PORT = 7447
DEPTH = BY_NAME["depth"]
CUT_SECONDS = 3.0
"""Length of the cut, a fact of the test: several times what the robot waits before it stops."""
SET_POINT = 0.5
"""m"""
LATEST = 10.0
"""s, the part of the session that is read each time."""
TURN = 0.01
"""m above its deepest place, the robot has turned."""


def main() -> None:
    data = Path(sys.argv[1])
    data.mkdir(parents=True)
    text = (ROOT / "robot.toml").read_text()
    for before, after in (
        ('\nmode = "emulated"', '\nmode = "hil"'),
        ('\nsimulator = "here"', '\nsimulator = "elsewhere"'),
        ("\nlisten = []", f'\nlisten = ["tls/{HERE}:{PORT}"]'),
    ):
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    (data / "robot.toml").write_text(text)
    reports: dict[str, Any] = {}
    mucat = str(Path(sys.executable).parent / "mucat")
    robot = ["--data", str(data / "data"), "--config", str(data / "robot.toml")]
    subprocess.run(
        [mucat, "certificate", "issue", "pool", "--to", str(data / "pool"), *robot],
        check=True,
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
    )
    there = ["--connect", f"tls/{HERE}:{PORT}", "--certificate", str(data / "pool")]
    with (
        TwoHosts(delay=0.02, jitter=0.01, loss=0.01) as hosts,
        Stack(data / "data", "--config", str(data / "robot.toml")) as stack,
    ):
        silent = "The board sends no status. Wait a moment, or reset it."
        wait(lambda: silent not in refusals(stack), "the board's first status", stack)
        reports["alone"] = refusals(stack)
        simulator = subprocess.Popen(
            [mucat, "simulator", *there],
            cwd=ROOT,
            preexec_fn=hosts.enter_there,
        )
        try:
            wait(lambda: refusals(stack) == [], "the simulator", stack)
            reports["simulator"] = health(stack, "simulator")
            if missing() is None:
                wait(lambda: state(stack)["camera"] == "rendered scene", "pictures of the scene", stack)
            session = stack.api.post("/sessions", json={"name": "in the loop"}).json()
            stack.arm()
            wait(LoopDive(stack, session["id"]).has_turned, "the turn below the set point", stack)
            reports["armed"] = state(stack)["armed"]
            hosts.loss = 1.0
            wait(lambda: not state(stack)["armed"], "the stop after the cut", stack)
            time.sleep(CUT_SECONDS)
            reports["cut"] = refusals(stack)
            hosts.loss = 0.01
            wait(lambda: len(refusals(stack)) == 1, "the simulator's return", stack)
            reports["back"] = state(stack)["mode"]
            acknowledge = "/robot/commands/acknowledge"
            wait(lambda: stack.api.post(acknowledge).is_success, "the runtime to be acknowledged", stack)
            wait(lambda: refusals(stack) == [], "the acknowledgement", stack)
            stack.api.post(f"/sessions/{session['id']}/stop").raise_for_status()
            (data / "session.zip").write_bytes(export_session(stack.api, session["id"]).content)
        finally:
            simulator.terminate()
            simulator.wait(SECONDS)
        reports["packets"] = hosts.packets
    print(json.dumps(reports))  # noqa: T201 - it speaks to the test that started it


def state(stack: Stack) -> dict[str, Any]:
    answer: dict[str, Any] = stack.api.get("/robot").json()
    return answer


class LoopDive:
    """Follows the depth of a session that has just begun."""

    def __init__(self, stack: Stack, session: int) -> None:
        self._stack, self._session = stack, session
        self._began = time.monotonic()
        self._deepest = 0.0

    def has_turned(self) -> bool:
        """Return True once the robot was below its set point and rises again; to be asked often."""
        start = max(time.monotonic() - self._began - LATEST, 0.0)
        span = {"start": start, "end": start + RANGE_MAX}
        answer = self._stack.api.get(f"/sessions/{self._session}/blocks", params=span)
        blocks = [block for block in read_blocks(answer.raise_for_status().content) if block.topic is DEPTH]
        rows = [record for block in blocks for _, record in read_rows(block)]
        depths = [record.depth for record in rows if isinstance(record, Depth)]
        self._deepest = max([self._deepest, *depths])
        return bool(depths) and depths[-1] < self._deepest - TURN and self._deepest > SET_POINT


def refusals(stack: Stack) -> list[str]:
    result: list[str] = state(stack)["refusals"]
    return result


def health(stack: Stack, name: str) -> str:
    parts = stack.api.get("/health").json()["parts"]
    return next(f"{part['state']}: {part['text']}" for part in parts if part["name"] == name)


def wait(condition: Callable[[], object], what: str, stack: Stack) -> None:
    end = time.monotonic() + SECONDS
    while not condition():
        if time.monotonic() >= end:
            short = {name: value for name, value in state(stack).items() if name != "loops"}
            raise AssertionError(f"waited in vain for {what}: {short}")
        time.sleep(0.05)


if __name__ == "__main__":
    main()
