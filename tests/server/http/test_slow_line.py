"""The whole robot on a slow line, as `mucat run` starts it with another baud in robot.toml."""

import time
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.contract.packets import Depth
from robot_runtime.transport.blocks import read_blocks, read_rows
from robot_runtime.transport.outbox import STREAM
from robot_runtime.transport.zenoh_transport import join
from tests.stack import ROOT, Stack
from tests.waiting import SECONDS

pytestmark = pytest.mark.stack

BAUD = 9600
DEEP = 0.4
"""m; its set point is 0.5."""


def test_the_whole_robot_dives_at_9600_baud(tmp_path: Path) -> None:
    text = (ROOT / "robot.toml").read_text()
    assert text.count("\nbaud = 250000") == 1
    config = tmp_path / "robot.toml"
    config.write_text(text.replace("\nbaud = 250000", f"\nbaud = {BAUD}"))
    with Stack(tmp_path / "data", "--config", str(config)) as stack:
        stack.arm()
        frames = wait_for_navigation(stack)
        wait_for_depth(stack)
        state = stack.api.get("/robot").json()
        assert (state["baud"], state["armed"]) == (BAUD, True)
        assert {pace["topic"]: round(pace["period"], 2) for pace in state["paces"]}["depth"] == 0.07
        kinds = {kind for frame in frames["frames"] if not frame["sent"] for kind in frame["kinds"]}
        assert {"Imu", "Depth", "Motor", "Beacon", "Status"} <= kinds
        assert frames["fault"] is None
        stack.api.post("/robot/stop").raise_for_status()
        wait_for(stack, lambda state: not state["armed"])


def wait_for(stack: Stack, holds: Any) -> None:
    end = time.monotonic() + SECONDS
    while not holds(stack.api.get("/robot").json()):
        assert time.monotonic() < end, stack.api.get("/robot").json()
        time.sleep(0.05)


def wait_for_depth(stack: Stack) -> None:
    """Wait until the robot's own sensor shows this depth."""
    depths: list[float] = []

    def take(_: str, data: bytes) -> None:
        for block in read_blocks(data):
            if block.topic.name == "depth":
                depths.extend(record.depth for _, record in read_rows(block) if isinstance(record, Depth))

    end = time.monotonic() + SECONDS
    runtime = f"unixsock-stream/{stack.data}/run/runtime.sock"
    with join("turtle", [runtime]) as messages:
        messages.subscribe(STREAM, take)
        while not depths or depths[-1] < DEEP:
            assert time.monotonic() < end, (depths[-5:], stack.api.get("/robot").json())
            time.sleep(0.05)


def wait_for_navigation(stack: Stack) -> Any:
    """Return the last frames, once an acknowledged navigation command is among them."""
    end = time.monotonic() + SECONDS
    while True:
        frames = stack.api.get("/link/frames").json()
        sent = [frame for frame in frames["frames"] if frame["sent"] and "Navigation" in frame["kinds"]]
        if len(sent) > 10:
            return frames
        assert time.monotonic() < end
        time.sleep(0.1)
