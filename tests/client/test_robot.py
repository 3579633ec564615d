"""The package mucat against the whole emulated robot."""

import asyncio
from pathlib import Path

import pytest

from mucat import (
    Control,
    FolderSessions,
    Robot,
    RobotError,
    SessionRecording,
    Sessions,
    SessionTables,
)
from tests.server.waiting import until
from tests.stack import Stack


def make_token(stack: Stack, scope: str) -> str:
    name = f"client {scope} {len(stack.api.get('/access/devices').json())}"
    answer = stack.api.post("/access/tokens", json={"name": name, "scope": scope})
    return str(answer.raise_for_status().json()["token"])


@pytest.mark.stack
def test_a_program_reads_drives_and_loads_what_it_recorded(shared_stack: Stack) -> None:
    token = make_token(shared_stack, "operate")
    robot = Robot(shared_stack.url, token)
    other = Robot(shared_stack.url, make_token(shared_stack, "operate"))
    before = {session["id"] for session in Sessions(shared_stack.url, token).list()}
    samples = robot.live("depth", "imu")
    results = {}
    for sample in samples:
        results[sample.topic] = sample
        if len(results) == 2:
            break
    samples.close()
    assert -0.2 < results["depth"]["depth"] < 5
    assert results["imu"]["force"][2] == pytest.approx(-9.8, abs=1.5)
    with robot.control() as control:
        control.arm("manual")
        control.drive(1.0, x=0.5, yaw=0.25)
        assert robot.state()["armed"]
        with pytest.raises(RobotError, match="Control is with"):
            other.control().__enter__()
    assert next(state for state in robot.live("state") if not state["armed"])["mode"] == "disarmed"
    sessions = Sessions(shared_stack.url, token)
    (session,) = (session["id"] for session in sessions.list() if session["id"] not in before)
    # What came last is stored with its end. Refused where it has just ended by itself.
    shared_stack.api.post(f"/sessions/{session}/stop")
    tables = sessions.load(session)
    assert tables.units("depth")["depth"] == "m"
    depth = tables.pandas("depth")
    assert depth["time"].is_monotonic_increasing
    assert depth.attrs["units"]["temperature"] == "°C"
    assert max(tables.pandas("navigation")["x"]) == pytest.approx(0.5, abs=0.01)
    with pytest.raises(RobotError, match="has no topic"):
        tables.pandas("height")


@pytest.mark.stack
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


SWIM = """
name = "client"
title = "A short swim"
description = "It arms and stops."
seed = 3
duration = 6

[scene]
kind = "pool"
depth = 3.0
length = 10.0
width = 5.0

[[events]]
at = 1
do = "arm"

[[events]]
at = 6
do = "stop"
"""


@pytest.mark.stack
def test_scenarios_run_and_their_sessions_are_compared_and_read_from_files(
    shared_stack: Stack, tmp_path: Path
) -> None:
    token = make_token(shared_stack, "operate")
    robot, sessions = Robot(shared_stack.url, token), Sessions(shared_stack.url, token)
    first, second = robot.run_scenario(SWIM), robot.run_scenario(SWIM)
    assert second > first
    entry, other = sessions.compare([first, second], ["depth.depth"])["sessions"]
    assert entry["series"]["depth.depth"] == other["series"]["depth.depth"]
    job = shared_stack.api.post("/exports", json={"session": first, "format": "csv"}).json()
    position = f"/exports/{job['id']}"
    asyncio.run(until(lambda: shared_stack.api.get(position).json()["state"] == "done", "the export"))
    file = tmp_path / "dive.zip"
    file.write_bytes(shared_stack.api.get(f"{position}/file").content)
    tables = Sessions.read(file)
    assert tables.pandas("depth").equals(sessions.load(first).pandas("depth"))
    assert tables.polars("depth")["time"].to_list() == tables.pandas("depth")["time"].to_list()
    with pytest.raises(RobotError, match="title is missing"):
        robot.run_scenario("name = 1")


MISSION = """
format = 1
name = "client"
title = "Down and up"

[limits]
depth = 1.0
time = 60

[mission]
do = "sequence"
steps = [
  { do = "dive", depth = 0.3, timeout = 30 },
  { do = "surface" },
]
"""


@pytest.mark.stack
def test_a_mission_runs_to_its_end_and_is_tried_in_simulated_water(shared_stack: Stack) -> None:
    robot = Robot(shared_stack.url, make_token(shared_stack, "operate"))
    with robot.control() as control:
        with pytest.raises(RobotError, match="mission is missing"):
            control.run_mission("format = 1\nname = 'x'")
        ended = control.run_mission(MISSION)
    assert (ended["title"], ended["phase"]) == ("Down and up", "succeeded")
    assert 0.2 < ended["deepest"] < 0.6
    tried = robot.try_mission(MISSION, seeds=2)
    assert [(trial["seed"], trial["phase"]) for trial in tried] == [(1, "succeeded"), (2, "succeeded")]


def test_what_is_no_export_is_refused(tmp_path: Path) -> None:
    (tmp_path / "dive.zip").write_bytes(b"PK no zip")
    with pytest.raises(RobotError, match="is no export of a session"):
        Sessions.read(tmp_path / "dive.zip")
    with pytest.raises(RobotError, match="cannot be read"):
        Sessions.read(tmp_path / "none.zip")
    with pytest.raises(RobotError, match="begins with http"):
        Robot("turtle.local", "mucat_token")
    with pytest.raises(RobotError, match="does not answer"):
        Robot("http://127.0.0.1:9", "mucat_token").state()


@pytest.mark.parametrize("kind", [Robot, SessionRecording, Control, Sessions, FolderSessions, SessionTables])
def test_the_reference_has_every_method(kind: type) -> None:
    page = (Path(__file__).parents[2] / "docs/reference/python.md").read_text()
    methods = [name for name in vars(kind) if not name.startswith("_") and callable(getattr(kind, name))]
    assert methods
    assert [name for name in methods if f"`{name}(" not in page] == []
