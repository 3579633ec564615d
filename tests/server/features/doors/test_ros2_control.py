"""Driving and STOP by zenoh-ros2-sdk, with control and without."""

import asyncio
from typing import Any

import pytest

from server.driving.arbiter import ControlArbiter
from server.features.doors.house import Doors
from server.platform.settings import Settings
from tests.server.features.doors.rig import (
    acts_of,
)
from tests.server.features.doors.ros2_rig import (
    Ros2Peer,
    doors_of,
    issue,
    open_zenoh,
    refused,
    ros2_peer,
    tls_settings,
    with_ros2,
)
from tests.server.ports import reserved_port
from tests.server.serving import Served
from tests.server.waiting import SECONDS, until

TWIST = "geometry_msgs/msg/Twist"
EMPTY = "std_msgs/msg/Empty"


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return with_ros2(settings)


async def test_a_program_drives_with_control_and_not_without(served: Served) -> None:
    folder = await issue(served)
    async with ros2_peer(served, tls_settings(served, folder)) as peer:

        async def call(name: str) -> tuple[bool, str]:
            return await asyncio.to_thread(peer.call, f"/mucat/{name}")

        wheel = await asyncio.to_thread(peer.publisher, "/cmd_vel", TWIST)
        success, reason = await call("take_control")
        assert (success, "Control is with" in reason) == (False, True)
        await steer(peer, wheel)
        await until(lambda: refused(served) == 2, "the refusal")
        assert (await call("arm"))[0] is False
        await served.api.post("/control/release")
        assert await call("take_control") == (True, "You have control.")
        assert (await call("arm"))[0] is True
        assert served.runtime.asked[-1] == ("arm", {"mode": "manual"})
        await steer(peer, wheel)
        await until(lambda: served.runtime.driven, "the command")
        assert served.runtime.driven[0]["axes"] == [0.5, -0.25, 1.0, 0.1, -0.2, -0.3]
        (client,) = await doors_of(served)
        assert client["in_control"] is True
        assert await call("release_control") == (True, "Control is released.")
        assert served.get(ControlArbiter).lease.holder is None
    expected = {
        ("Lab", "Open a door", "done"),
        ("Lab", "Take control", "refused"),
        ("Lab", "Message drive", "refused"),
        ("Lab", "arm", "refused"),
        ("Lab", "Take control", "done"),
        ("Lab", "arm", "done"),
        ("Lab", "Drive", "done"),
        ("Lab", "Release control", "done"),
    }
    async with asyncio.timeout(SECONDS):
        while missing := expected - await acts_of(served):
            await asyncio.sleep(0.01)
    assert not missing


async def test_a_viewer_behind_a_router_stops_the_robot_and_does_nothing_else(served: Served) -> None:
    """As ROS 2 is used: the router has the certificate, the node speaks to the router."""

    with reserved_port() as port:
        address = f"tcp/127.0.0.1:{port}"
        folder = await issue(served, "read")
        own = {"mode": "router", "listen/endpoints": [address]}
        router = await asyncio.to_thread(open_zenoh, own | tls_settings(served, folder))
        try:
            async with ros2_peer(served, {"mode": "peer", "connect/endpoints": [address]}) as peer:
                horn = await asyncio.to_thread(peer.publisher, "/mucat/stop", EMPTY)
                success, reason = await asyncio.to_thread(peer.call, "/mucat/take_control")
                assert (success, "operator" in reason) == (False, True)
                await asyncio.to_thread(horn.publish, structure_needs_at_least_one_member=0)
                await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")
                assert (await asyncio.to_thread(peer.call, "/mucat/stop"))[0] is True
                assert [name for name, _ in served.runtime.asked if name != "there"] == ["stop", "stop"]
        finally:
            await asyncio.to_thread(router.close)
        await until(lambda: not served.get(Doors).doors["ros2"].clients, "the end")


async def steer(peer: Ros2Peer, wheel: Any) -> None:
    vector = peer.type("geometry_msgs/msg/Vector3")
    linear, angular = vector(x=0.5, y=0.25, z=-7.0), vector(x=0.1, y=0.2, z=0.3)
    await asyncio.to_thread(wheel.publish, linear=linear, angular=angular)
