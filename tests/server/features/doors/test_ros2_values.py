"""The values of ROS 2's topics, as zenoh-ros2-sdk reads them."""

import asyncio
import base64
from collections.abc import Set
from dataclasses import fields, is_dataclass, replace
from math import nan
from typing import Any

import numpy
import pytest

from robot_runtime.contract.documents import Control
from robot_runtime.contract.packets import Beacon, Depth, Motor, Status
from server.features.doors.house import Doors
from server.features.doors.ros_channels import standard_channels
from server.platform.settings import Settings
from tests.server.blocks import debug_block, picture_block
from tests.server.features.doors.rig import (
    RosbridgeClient,
    imu,
    make_token,
    open_rosbridge,
    rows_block,
    truth,
)
from tests.server.features.doors.ros2_rig import (
    OPEN,
    Ros2Peer,
    doors_of,
    issue,
    ros2_peer,
    subscribed,
    tls_settings,
    with_ros2,
)
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, until

MARK = "marked"
TURNED = (0.9, 0.1, -0.2, 0.374)


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return with_ros2(settings)


async def test_a_program_gets_the_values_of_rosbridge(served: Served) -> None:
    """Every standard topic, through both doors, from the same samples."""

    folder, token = await issue(served, "read"), await make_token(served, "read", "Page")
    channels = {channel.name: channel for channel in standard_channels()}
    async with (
        ros2_peer(served, tls_settings(served, folder)) as peer,
        open_rosbridge(served, token) as socket,
    ):
        page = RosbridgeClient(socket)
        for name, channel in channels.items():
            await page.say(op="subscribe", topic=name)
            await asyncio.to_thread(peer.subscribe, name, channel.type)
        await until(lambda: len(subscribed(served)) == len(channels), "all subscriptions")
        for topic in ("picture", "observer", "mask", "balanced"):
            await served.heard(topic)
        with_attitude = {"/imu/data", "/pose", "/tf"}
        for publish, names in (
            (publish_most, channels.keys() - with_attitude),
            (publish_attitude, with_attitude),
        ):
            publish(served)
            theirs, ours = await asyncio.gather(by_rosbridge(page, names), by_ros2(peer, names))
            for name in names:
                assert not differences(ours[name], theirs[name]), name
        assert ours["/imu/data"]["linear_acceleration.z"] == pytest.approx(9.5, abs=1e-3)
        (client,) = await doors_of(served)
        assert (client["name"], client["role"], set(client["topics"])) == ("Lab", "viewer", {*channels})


async def test_domain_and_namespace_are_the_configured_ones(settings: Settings) -> None:
    own = replace(OPEN, ros2_domain=7, ros2_namespace="/turtle")
    async with serve(with_ros2(settings, own)) as served:
        folder = await issue(served)
        async with ros2_peer(served, tls_settings(served, folder), domain=7) as peer:
            await asyncio.to_thread(peer.subscribe, "/turtle/depth", "std_msgs/msg/Float64")
            await until(lambda: subscribed(served) == {"/depth"}, "the subscription")
            served.runtime.publish(depth_block(served, 0.25))
            assert (await peer.next("/turtle/depth")).data == pytest.approx(0.25)
            assert (await asyncio.to_thread(peer.call, "/turtle/mucat/stop"))[0] is True
            nodes = await asyncio.to_thread(peer.tokens, "@ros2_lv/7/*/*/*/NN/**")
            assert any(node.endswith("/NN/%/%turtle/mucat") for node in nodes)


async def test_a_late_subscriber_of_a_latched_topic_gets_the_newest_message(served: Served) -> None:
    folder = await issue(served, "read")
    kind = "diagnostic_msgs/msg/DiagnosticArray"
    async with ros2_peer(served, tls_settings(served, folder)) as peer:
        served.get(Doors).see_health([{"name": "board", "state": "failed", "text": "Gone."}])
        await asyncio.to_thread(peer.subscribe, "/diagnostics", kind)
        first = await peer.next("/diagnostics")
        await asyncio.to_thread(peer.subscribe, "/diagnostics", kind, ":1:,1:,:,:,,")
        assert (await peer.next("/diagnostics")).status[0].name.startswith("mucat: ")
        assert first.status[0].name.startswith("mucat: ")


def depth_block(served: Served, depth: float) -> Any:
    now = served.container.clock.now()
    return rows_block("depth", 0, (now, Depth(time=0, depth=depth, pressure=108_000, temperature=18.5)))


def publish_attitude(served: Served) -> None:
    """A sample of the IMU; the pose needs it after the position."""
    now = served.container.clock.now()
    served.runtime.publish(
        rows_block("imu", 0, (now, imu(TURNED, rate=(0.1, 0.2, 0.3), force=(1.0, 2.0, -9.5))))
    )


def publish_most(served: Served) -> None:
    """A sample of each other topic."""
    served.get(Doors).see_health([{"name": "board", "state": "failed", "text": MARK}])
    now = served.container.clock.now()
    flags: dict[str, Any] = dict.fromkeys(Status.wires, 0) | {"battery": 7.4}
    control = dict.fromkeys(Control.wires, 0.25)
    motor: dict[str, Any] = {
        "time": 0,
        "wanted": (0.0,) * 4,
        "angle": (0.1, -0.2, 0.3, -0.4),
        "drive": (0,) * 4,
    }
    served.runtime.publish(
        rows_block("truth", 0, (now, truth((1.0, 2.0, 0.7), TURNED))),
        depth_block(served, 0.7),
        rows_block("status", 0, (now, Status(**flags))),
        rows_block("motor", 0, (now, Motor(**motor))),
        rows_block("beacon", 0, (now, Beacon(time=0, right=0, left=1))),
        rows_block("control", 0, (now, Control(**control))),
        debug_block(0, "hello"),
        # All four find room in what Zenoh holds, so that the door drops none, as it may.
        *(picture_block(0, 3000, topic) for topic in ("picture", "observer", "mask", "balanced")),
    )


async def by_rosbridge(page: RosbridgeClient, topics: Set[str]) -> dict[str, dict[str, Any]]:
    """Return the newest message of each topic, flat."""
    results: dict[str, dict[str, Any]] = {}
    while results.keys() != topics:
        message = await page.next("publish")
        if message["topic"] in topics and matches(message["topic"], flat := flatten(message["msg"])):
            results[message["topic"]] = flat
    return results


async def by_ros2(peer: Ros2Peer, topics: Set[str]) -> dict[str, dict[str, Any]]:
    """Return the same at the other door."""
    results: dict[str, dict[str, Any]] = {}
    while results.keys() != topics:
        topic, message = await asyncio.to_thread(peer.received.get, timeout=SECONDS)
        if topic in topics and matches(topic, flat := flatten(message)):
            results[topic] = flat
    return results


def matches(topic: str, message: dict[str, Any]) -> bool:
    """Return False for the server's own lines and health, of which each door may send others first."""
    expected = {"/rosout": ("msg", "hello"), "/diagnostics": ("status.0.message", MARK)}
    key, value = expected.get(topic, ("", None))
    return message.get(key) == value


def differences(item: dict[str, Any], other: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the values that are not equal; of 32 bits, or in JSON, a number may be rounded."""
    pairs = {key: (item.get(key), other.get(key)) for key in item.keys() | other.keys()}
    return {
        key: (first, second)
        for key, (first, second) in pairs.items()
        if first != (pytest.approx(second, rel=1e-6, nan_ok=True) if isinstance(second, float) else second)
    }


def flatten(value: Any, name: str = "") -> dict[str, Any]:
    """Return a message's plain values by path; base64, null and arrays of rosbridge as in ROS 2."""
    if is_dataclass(value):
        # Constants are fields here, too.
        names = [
            field.name for field in fields(value) if field.name.islower() and field.name != "__msgtype__"
        ]
        value = {name: getattr(value, name) for name in names}
    if isinstance(value, numpy.ndarray):
        value = bytes(value) if value.dtype == numpy.uint8 else value.tolist()
    if name == "data" and isinstance(value, str):
        value = base64.b64decode(value)
    if isinstance(value, dict):
        return {
            path: leaf
            for key, inner in value.items()
            for path, leaf in flatten(inner, join(name, key)).items()
        }
    if isinstance(value, list):
        return {name: len(value)} | flatten(dict(enumerate(value)), name)
    return {name: nan if value is None else value}


def join(name: str, key: object) -> str:
    return f"{name}.{key}" if name else str(key)
