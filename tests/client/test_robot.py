"""The package mucat against the whole emulated robot."""

import asyncio

import pytest

from mucat import Robot, RobotError, Sessions
from tests.stack import Stack

pytestmark = pytest.mark.stack


def make_token(stack: Stack, scope: str) -> str:
    name = f"client {scope} {len(stack.api.get('/access/devices').json())}"
    answer = stack.api.post("/access/tokens", json={"name": name, "scope": scope})
    return str(answer.raise_for_status().json()["token"])


def test_a_program_reads_drives_and_loads_what_it_recorded(shared_stack: Stack) -> None:
    token = make_token(shared_stack, "operate")
    robot = Robot(shared_stack.url, token)
    before = {one["id"] for one in Sessions(shared_stack.url, token).list()}
    samples = robot.live("depth", "imu")
    found = {}
    for sample in samples:
        found[sample.topic] = sample
        if len(found) == 2:
            break
    samples.close()
    assert -0.2 < found["depth"]["depth"] < 5
    assert found["imu"]["force"][2] == pytest.approx(-9.8, abs=1.5)
    with robot.control() as control:
        control.arm("manual")
        control.drive(1.0, x=0.5, yaw=0.25)
        assert robot.state()["armed"]
        with pytest.raises(RobotError, match="Control is with"):
            Robot(shared_stack.url, make_token(shared_stack, "operate")).control().__enter__()
    assert next(one for one in robot.live("state") if not one["armed"])["mode"] == "disarmed"
    sessions = Sessions(shared_stack.url, token)
    (session,) = (one["id"] for one in sessions.list() if one["id"] not in before)
    tables = sessions.load(session)
    assert tables.units("depth")["depth"] == "m"
    depth = tables.pandas("depth")
    assert depth["time"].is_monotonic_increasing
    assert depth.attrs["units"]["temperature"] == "°C"
    assert max(tables.pandas("navigation")["x"]) == pytest.approx(0.5, abs=0.01)
    with pytest.raises(RobotError, match="has no topic"):
        tables.pandas("height")


def test_a_reader_may_read_and_stop_and_nothing_else(shared_stack: Stack) -> None:
    robot = Robot(shared_stack.url, make_token(shared_stack, "read"))

    async def first() -> float:
        async for sample in robot.live_async("depth"):
            return float(sample["depth"])
        raise AssertionError("no sample came")

    assert -0.2 < asyncio.run(first()) < 5
    robot.stop()
    with pytest.raises(RobotError, match="role of an operator"), robot.control():
        pass
    with pytest.raises(RobotError, match="not signed in"):
        Robot(shared_stack.url, "mucat_wrong").state()
    with pytest.raises(RobotError, match="There is no topic"):
        next(robot.live("height"))
