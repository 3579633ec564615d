"""The certificates with which programs of ROS 2 get in, and how their access ends."""

import asyncio
from dataclasses import replace
from typing import Any

import pytest
import zenoh

from server.driving.arbiter import ControlArbiter
from server.features.doors.config import DoorsConfig
from server.features.doors.house import Doors
from server.features.doors.ros2_door import Ros2Door
from server.platform.authority import Authority
from server.platform.settings import Settings
from tests.server.features.doors.rig import (
    TokenTime,
    acts_of,
)
from tests.server.features.doors.ros2_rig import (
    issue,
    open_zenoh,
    ros2_peer,
    subscribed,
    tls_settings,
    with_ros2,
)
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, until


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return with_ros2(settings)


async def test_the_door_is_closed_unless_the_configuration_opens_it(settings: Settings) -> None:
    async with serve(settings.with_section(DoorsConfig(foxglove=True))) as served:
        (door,) = (door for door in (await served.api.get("/doors")).json() if door["name"] == "ros2")
        assert (door["open"], door["clients"]) == (False, [])
        assert served.get(Ros2Door).address == ("", 0)


async def test_only_a_certificate_that_is_in_force_gets_in(settings: Settings, served: Served) -> None:
    folder = await issue(served)
    base = settings.data.path.parent
    await asyncio.to_thread(Authority(served.settings).issue, "pool", base / "simulator")
    other = replace(served.settings, data=type(settings.data)(base / "other"))
    await asyncio.to_thread(Authority(other).issue_program, "anything", base / "stranger")
    (base / "stranger" / "authority.pem").write_bytes((folder / "authority.pem").read_bytes())
    whole = tls_settings(served, folder)
    plain = {"connect/endpoints": [whole["connect/endpoints"][0].replace("tls", "tcp")]}
    others = (tls_settings(served, base / name) for name in ("simulator", "stranger"))
    assert not any(await asyncio.gather(*map(gets_something, (plain, *others))))
    assert await gets_something(tls_settings(served, folder), SECONDS)
    async with asyncio.timeout(SECONDS):
        # The log has a thread of its own.
        while ("", "Open a door", "refused") not in await acts_of(served):
            await asyncio.sleep(0.01)
    devices = (await served.api.get("/access/devices")).json()
    (device,) = (device["id"] for device in devices if device["name"] == "Lab")
    (await served.api.delete(f"/access/devices/{device}")).raise_for_status()
    assert not await gets_something(tls_settings(served, folder))


async def test_a_revoked_certificate_ends_its_connection_and_control(
    settings: Settings, served: Served
) -> None:
    await served.api.post("/control/release")
    folder = await issue(served)
    async with ros2_peer(served, tls_settings(served, folder)) as peer:
        assert (await asyncio.to_thread(peer.call, "/mucat/take_control"))[0] is True
        devices = (await served.api.get("/access/devices")).json()
        (device,) = (device["id"] for device in devices if device["name"] == "Lab")
        (await served.api.delete(f"/access/devices/{device}")).raise_for_status()
        await until(lambda: served.get(ControlArbiter).lease.holder is None, "control to be free")
        await until(lambda: not served.get(Doors).doors["ros2"].clients, "the end")
        await until(lambda: not [*settings.data.run.glob("ros2-*")], "its socket to be removed")


async def test_a_certificate_that_ends_ends_its_connection(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    folder = await issue(served, "read")
    lasting = TokenTime(served, monkeypatch, "Lab")
    async with ros2_peer(served, tls_settings(served, folder)) as peer:
        await asyncio.to_thread(peer.subscribe, "/depth", "std_msgs/msg/Float64")
        await until(lambda: subscribed(served) == {"/depth"}, "the subscription")
        lasting.end()
        await until(lambda: not served.get(Doors).doors["ros2"].clients, "the end")


async def gets_something(values: dict[str, Any], seconds: float = 2.0) -> bool:
    """Return True if a session with these settings sees the robot's node within this time."""

    def look() -> bool:
        try:
            session = open_zenoh({"mode": "client", "connect/timeout_ms": int(seconds * 1000)} | values)
        except zenoh.ZError:
            return False
        try:
            return any(reply.ok for reply in session.liveliness().get("@ros2_lv/**", timeout=seconds))
        finally:
            session.close()  # type: ignore[no-untyped-call]

    return await asyncio.to_thread(look)
