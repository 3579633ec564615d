"""A robot joins a lab by a code: two servers in the test's event loop, with the lab's router as a process."""

import asyncio
import json
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import httpx
import pytest

from robot_runtime.clock import SteadyClock
from robot_runtime.config import RobotConfig
from robot_runtime.contract.topics import STATE
from robot_runtime.transport.blocks import Block
from server.features.membership import presence_source
from server.features.membership.presence_source import PresenceSource
from server.features.roster.joining_codes import JoiningCodes, LabWithoutTlsError
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record_batches
from tests.server.features.lab.pulled_robot import saying_state
from tests.server.features.roster.served_lab import RosterLab, serve_lab
from tests.server.ports import reserved_port
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS


@pytest.fixture
async def lab(tmp_path: Path) -> AsyncIterator[RosterLab]:
    with reserved_port() as port:
        async with serve_lab(tmp_path, port) as lab:
            yield lab


@pytest.fixture
async def robot(settings: Settings) -> AsyncIterator[Served]:
    settings = replace(settings, robot=RobotConfig(name="turtle-1"))
    async with serve(settings.with_section(replace(settings.server, tls=True))) as served:
        yield served


async def join(robot: Served, made: dict[str, Any]) -> httpx.Response:
    """Ask the robot to join by a code."""
    return await robot.api.post("/lab/join", json={"address": made["address"], "code": made["code"]})


def state(robot: Served, **values: object) -> Block:
    """Return the robot's state, as it sends it now."""
    now = robot.container.clock.now()
    document = {"time": now, "mode": "manual", "armed": True, "connected": True, "alarms": [], **values}
    return Block.of(STATE, 1, 0, json.dumps([document]).encode())


async def test_a_robot_joins_is_seen_stopped_and_leaves(lab: RosterLab, robot: Served) -> None:
    assert (await robot.api.get("/lab")).json()["name"] is None
    joined = (await join(robot, await lab.code())).raise_for_status().json()
    assert joined["name"]
    robot.runtime.publish(state(robot))
    seen = await lab.see("the armed robot", armed=True, mode="manual")
    assert (seen["name"], seen["present"]) == ("turtle-1", True)
    assert seen["address"] == f"https://localhost:{robot.settings.server.port}"
    assert (await robot.api.get("/lab")).json()["connected"]

    asked = len(robot.runtime.asked)
    answers = (await lab.api.post("/robots/stop")).json()
    assert answers == [{"name": "turtle-1", "stopped": True, "zenoh": "", "https": ""}]
    assert {name for name, _ in robot.runtime.asked[asked:]} == {"stop"}

    device = next(d for d in (await robot.api.get("/access/devices")).json() if d["kind"] == "lab")
    assert (device["role"], device["name"]) == ("viewer", "Lab 127.0.0.1")
    assert (await robot.api.delete("/lab")).json() == {"notified": True}
    async with asyncio.timeout(SECONDS):
        while await lab.robots():
            await asyncio.sleep(0.02)
    assert (await robot.api.get("/access/devices")).json() == []
    assert not robot.settings.data.membership.exists()


async def test_joining_is_all_that_the_lab_s_archive_needs(lab: RosterLab, robot: Served) -> None:
    session = await record_batches(robot.get(Store), robot.settings, [depth_block(0, 500)], name="dive")
    async with saying_state(robot):
        (await join(robot, await lab.code())).raise_for_status()
        async with asyncio.timeout(SECONDS):
            while [pull["phase"] for pull in (await lab.api.get("/lab/pulls")).json()] != ["done"]:
                await asyncio.sleep(0.02)
    (pull,) = (await lab.api.get("/lab/pulls")).json()
    assert (pull["robot"], pull["sessions"], pull["lacking"]) == ("turtle-1", 1, 0)
    assert [dive["name"] for dive in (await lab.api.get("/sessions")).json()] == ["dive"]
    assert (await robot.api.get(f"/sessions/{session}")).json()["archived"] is not None


async def test_a_robot_that_is_removed_loses_its_way_and_the_lab_its_token(
    lab: RosterLab, robot: Served
) -> None:
    (await join(robot, await lab.code())).raise_for_status()
    await lab.see("the robot", armed=False)
    (await lab.api.delete("/robots/turtle-1")).raise_for_status()
    assert await lab.robots() == []
    async with asyncio.timeout(SECONDS):
        while (await robot.api.get("/access/devices")).json():
            await asyncio.sleep(0.02)
    # It is free to join again.
    assert (await robot.api.delete("/lab")).status_code == 200
    (await join(robot, await lab.code())).raise_for_status()
    await lab.see("the robot again", armed=False)


async def test_a_robot_swims_on_without_its_lab(robot: Served, tmp_path: Path) -> None:
    with reserved_port() as port:
        async with serve_lab(tmp_path, port) as lab:
            (await join(robot, await lab.code())).raise_for_status()
            await lab.see("the robot", armed=False)
        assert (await robot.api.post("/robot/stop")).status_code == 204
        async with serve_lab(tmp_path, port) as again:
            await again.see("the robot, which has come back by itself", armed=False)


async def test_a_code_works_once_and_for_this_lab_alone(lab: RosterLab, robot: Served) -> None:
    made = await lab.code()
    code, pin = made["code"][:11], made["code"][12:]
    wrong = made | {"code": f"{code}-{'A' * 8}-{'A' * 8}"}
    refused = await join(robot, wrong)
    assert (refused.status_code, "another certificate" in refused.json()["detail"]) == (503, True)
    # Nothing was sent to a lab that is another one: the code is not used up.
    (await join(robot, made)).raise_for_status()
    assert (await join(robot, made)).json()["detail"].startswith("This robot has joined the lab")
    (await robot.api.delete("/lab")).raise_for_status()
    again = await join(robot, made)
    assert (again.status_code, again.json()["detail"]) == (
        409,
        "The lab refused: This code is not valid. A code works once, for ten minutes; the page Robots of the "
        "lab makes another, or `mucat lab pair` on its computer.",
    )
    assert (await robot.api.get("/access/devices")).json() == []
    for code in ("", "7K3PX-Q2M9D", pin):
        answer = await join(robot, made | {"code": code})
        assert answer.status_code == 422


@pytest.mark.parametrize(
    "address", ["http://lab:8000", "lab:8000", "https://", "https://lab:0", "https://a@lab", "ftp://lab"]
)
async def test_what_is_no_address_of_a_lab_is_refused(robot: Served, address: str) -> None:
    code = "7K3PX-Q2M9D-ABCDEFGH-JKMNPQRS"
    answer = await robot.api.post("/lab/join", json={"address": address, "code": code})
    assert (answer.status_code, "no address of a lab" in answer.json()["detail"]) == (422, True)


async def test_two_robots_of_one_name_do_not_join(lab: RosterLab, robot: Served) -> None:
    (await join(robot, await lab.code())).raise_for_status()
    made = await lab.code()
    body = {"name": "turtle-1", "address": "", "fingerprint": "", "token": "t"}
    second = await lab.api.post("/robots/join", json=body | {"code": made["code"][:11]})
    assert (second.status_code, "another name" in second.json()["detail"]) == (409, True)


async def test_a_lab_without_tls_makes_no_code(lab: RosterLab) -> None:
    bare = lab.settings.with_section(replace(lab.settings.server, tls=False))
    with pytest.raises(LabWithoutTlsError, match=r"server\.tls = true"):
        JoiningCodes(bare, SteadyClock()).make("lab")


async def test_a_robot_that_is_renamed_stays_in_the_lab_by_the_name_it_joined_with(
    lab: RosterLab, settings: Settings
) -> None:
    settings = settings.with_section(replace(settings.server, tls=True))
    for name in ("turtle-1", "anna"):
        async with serve(replace(settings, robot=RobotConfig(name=name))) as robot:
            if name == "turtle-1":
                (await join(robot, await lab.code())).raise_for_status()
            address = f"https://localhost:{robot.settings.server.port}"
            seen = await lab.see("the robot at its present address", address=address)
            assert seen["name"] == "turtle-1"


async def test_a_robot_in_a_lab_joins_no_second_one(lab: RosterLab, robot: Served, tmp_path: Path) -> None:
    (await join(robot, await lab.code())).raise_for_status()
    with reserved_port() as port:
        async with serve_lab(tmp_path / "second", port) as second:
            refused = await join(robot, await second.code())
            assert (refused.status_code, "Leave it first" in refused.json()["detail"]) == (409, True)
            assert await second.robots() == []


def test_a_robot_tells_the_lab_its_address_in_the_lab_s_network(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    def address(lab: str, **server: Any) -> str:
        there = settings.with_section(replace(settings.server, port=80, **server))
        return PresenceSource(there, *[cast("Any", None)] * 3).address_for(lab)

    monkeypatch.setattr(presence_source, "_own_address", lambda _: "10.0.0.7")
    assert address("https://192.0.2.1:8000") == ""
    assert address("https://localhost:8000") == "http://localhost:80"
    names = ["localhost", "10.0.0.5"]
    assert address("https://192.0.2.1", host="10.0.0.5", allowed_hosts=names) == "http://10.0.0.5:80"
    # Its network has given it another address since the start.
    assert address("https://192.0.2.1", host="0.0.0.0", allowed_hosts=names) == "http://10.0.0.7:80"
    assert address("https://192.0.2.1", public_url="https://robots.lab") == "https://robots.lab"
