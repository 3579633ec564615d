"""A whole robot in a lab: it is seen and stopped, and swims on when its lab dies."""

import asyncio
from pathlib import Path

import pytest

from tests.server.features.roster.served_lab import serve_lab
from tests.server.ports import reserved_port
from tests.stack import Stack
from tests.waiting import wait_for

pytestmark = pytest.mark.stack


async def test_a_robot_is_stopped_by_its_lab_and_swims_on_without_it(
    shared_stack: Stack, tmp_path: Path
) -> None:
    robot = shared_stack
    await asyncio.to_thread(robot.calm)
    with reserved_port() as port:
        async with serve_lab(tmp_path, port) as lab:
            made = await lab.code()
            body = {"address": made["address"], "code": made["code"]}
            joined = await asyncio.to_thread(robot.api.post, "/lab/join", json=body)
            joined.raise_for_status()
            try:
                await asyncio.to_thread(robot.arm)
                seen = await lab.see("the armed robot", armed=True)
                assert seen["presence"]["depth"] is not None
                assert seen["presence"]["battery"] > 5
                (answer,) = (await lab.api.post("/robots/stop")).json()
                assert (answer["stopped"], answer["zenoh"], answer["https"]) == (True, "", "")
                await lab.see("the stopped robot", armed=False)
                await asyncio.to_thread(robot.calm)
                await asyncio.to_thread(robot.arm)
            except BaseException:
                await asyncio.to_thread(robot.api.delete, "/lab")
                raise
        # The lab is gone.
        try:
            gone = await asyncio.to_thread(_wait_for_loss, robot)
            assert gone["connected"] is False
            assert robot.api.get("/robot").json()["armed"]
            async with serve_lab(tmp_path, port) as again:
                await again.see("the robot, still armed", armed=True)
        finally:
            await asyncio.to_thread(robot.api.delete, "/lab")
            await asyncio.to_thread(robot.calm)


def _wait_for_loss(robot: Stack) -> dict[str, object]:
    """Wait until the robot knows that its lab is gone."""
    wait_for(lambda: not robot.api.get("/lab").json()["connected"], "the robot to miss its lab")
    lab: dict[str, object] = robot.api.get("/lab").json()
    return lab
