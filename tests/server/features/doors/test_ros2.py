"""The door for ROS 2 with the real Zenoh, and zenoh-ros2-sdk as an independent program."""

import asyncio
import base64
import time
from collections.abc import Set
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from math import nan
from typing import Any

import numpy
import pytest
import zenoh

from robot_runtime.contract.documents import Control
from robot_runtime.contract.packets import Beacon, Depth, Motor, Status
from server.features.doors.ros2_messages import PAYLOAD_MAX
from server.features.doors.ros2_node import read_payload
from server.features.doors.ros_channels import standard_channels
from server.platform.authority import Authority
from server.platform.settings import Settings
from tests.server.blocks import debug_block, picture_block
from tests.server.features.doors.rig import (
    RosbridgeClient,
    acts_of,
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
    open_zenoh,
    play_ros2,
    ros2_peer,
    tls_settings,
)
from tests.server.serving import Served, play
from tests.server.waiting import SECONDS, until
from tests.stack import free_port

TWIST = "geometry_msgs/msg/Twist"
EMPTY = "std_msgs/msg/Empty"
MARK = "marked"
TURNED = (0.9, 0.1, -0.2, 0.374)


def test_the_door_is_closed_unless_the_configuration_opens_it(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        (door,) = (one for one in (await served.api.get("/doors")).json() if one["name"] == "ros2")
        assert (door["open"], door["clients"]) == (False, [])
        assert served.container.ros2.address == ("", 0)

    play(settings, scenario)


def test_a_program_gets_the_values_of_rosbridge(settings: Settings) -> None:
    """Every standard topic, through both doors, from the same samples."""

    async def scenario(served: Served) -> None:
        folder, token = await issue(served, "read"), await make_token(served, "read", "Page")
        channels = {one.name: one for one in standard_channels()}
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

    play_ros2(settings, scenario)


def test_a_program_drives_with_control_and_not_without(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
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
            assert await call("release_control") == (True, "You do not have control.")
            assert served.container.arbiter.lease.holder is None
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

    play_ros2(settings, scenario)


def test_a_viewer_behind_a_router_stops_the_robot_and_does_nothing_else(settings: Settings) -> None:
    """As ROS 2 is used: the router has the certificate, the node speaks to the router."""

    async def scenario(served: Served) -> None:
        folder = await issue(served, "read")
        address = f"tcp/127.0.0.1:{free_port()}"
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
        await until(lambda: not served.container.doors.doors["ros2"].clients, "the end")

    play_ros2(settings, scenario)


def test_domain_and_namespace_are_the_configured_ones(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder = await issue(served)
        async with ros2_peer(served, tls_settings(served, folder), domain=7) as peer:
            await asyncio.to_thread(peer.subscribe, "/turtle/depth", "std_msgs/msg/Float64")
            await until(lambda: subscribed(served) == {"/depth"}, "the subscription")
            served.runtime.publish(depth_block(served, 0.25))
            assert (await peer.next("/turtle/depth")).data == pytest.approx(0.25)
            assert (await asyncio.to_thread(peer.call, "/turtle/mucat/stop"))[0] is True
            nodes = await asyncio.to_thread(peer.tokens, "@ros2_lv/7/*/*/*/NN/**")
            assert any(one.endswith("/NN/%/%turtle/mucat") for one in nodes)

    play_ros2(settings, scenario, replace(OPEN, ros2_domain=7, ros2_namespace="/turtle"))


def test_a_late_subscriber_of_a_latched_topic_gets_the_newest_message(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder = await issue(served, "read")
        kind = "diagnostic_msgs/msg/DiagnosticArray"
        async with ros2_peer(served, tls_settings(served, folder)) as peer:
            served.container.doors.see_health([{"name": "board", "state": "failed", "text": "Gone."}])
            await asyncio.to_thread(peer.subscribe, "/diagnostics", kind)
            first = await peer.next("/diagnostics")
            await asyncio.to_thread(peer.subscribe, "/diagnostics", kind, ":1:,1:,:,:,,")
            assert (await peer.next("/diagnostics")).status[0].name.startswith("mucat: ")
            assert first.status[0].name.startswith("mucat: ")

    play_ros2(settings, scenario)


def test_only_a_certificate_that_is_in_force_gets_in(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder = await issue(served)
        base = settings.data.path.parent
        await asyncio.to_thread(Authority(served.settings).issue, "pool", base / "simulator")
        other = replace(served.settings, data=type(settings.data)(base / "other"))
        await asyncio.to_thread(Authority(other).issue_program, "anything", base / "stranger")
        (base / "stranger" / "authority.pem").write_bytes((folder / "authority.pem").read_bytes())
        whole = tls_settings(served, folder)
        plain = {"connect/endpoints": [whole["connect/endpoints"][0].replace("tls", "tcp")]}
        assert not await gets_something(plain)
        for name in ("simulator", "stranger"):
            assert not await gets_something(tls_settings(served, base / name))
        assert await gets_something(tls_settings(served, folder), SECONDS)
        assert ("", "Open a door", "refused") in await acts_of(served)
        devices = (await served.api.get("/access/devices")).json()
        (device,) = (one["id"] for one in devices if one["name"] == "Lab")
        (await served.api.delete(f"/access/devices/{device}")).raise_for_status()
        assert not await gets_something(tls_settings(served, folder))

    play_ros2(settings, scenario)


def test_a_revoked_certificate_ends_its_connection_and_control(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        await served.api.post("/control/release")
        folder = await issue(served)
        async with ros2_peer(served, tls_settings(served, folder)) as peer:
            assert (await asyncio.to_thread(peer.call, "/mucat/take_control"))[0] is True
            devices = (await served.api.get("/access/devices")).json()
            (device,) = (one["id"] for one in devices if one["name"] == "Lab")
            (await served.api.delete(f"/access/devices/{device}")).raise_for_status()
            await until(lambda: served.container.arbiter.lease.holder is None, "control to be free")
            await until(lambda: not served.container.doors.doors["ros2"].clients, "the end")
            await until(lambda: not [*settings.data.run.glob("ros2-*")], "its socket to be removed")

    play_ros2(settings, scenario)


def test_what_is_not_valid_is_refused_and_counted(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder = await issue(served)
        session = await asyncio.to_thread(open_zenoh, {"mode": "client"} | tls_settings(served, folder))
        try:
            names = ("%cmd_vel", "%mucat%arm")
            twist, arm = [await asyncio.to_thread(key_of, session, name) for name in names]
            cut, filled = b"\0\1\0\0", b"\0\1\0\0" + b"\xff" * 48
            bad = [b"", b"\0", cut, filled, b"\7\7\0\0" + bytes(48), bytes(5000), bytes(10**6)]
            for payload in bad:
                session.put(twist, payload)
            session.put("0/cmd_vel/geometry_msgs::msg::dds_::TwistStamped_/RIHS01_0", bytes(60))
            await until(lambda: refused(served) >= len(bad), "the refusals")
            for payload in bad[:4]:
                assert not await asyncio.to_thread(answers, session, arm, payload)
            assert served.runtime.driven == []
            session.put("0/mucat/stop/std_msgs::msg::dds_::Bool_/RIHS01_0", b"")
            await until(lambda: ("stop", {}) in served.runtime.asked, "STOP by whatever message")
            assert [name for name, _ in served.runtime.asked if name != "there"] == ["stop"]
            await until(lambda: refused(served) >= len(bad) + 4, "the calls to be refused")
            (client,) = await doors_of(served)
            assert client["refused"] >= len(bad) + 4
        finally:
            await asyncio.to_thread(session.close)

    play_ros2(settings, scenario)


def test_a_program_that_reads_nothing_is_disconnected_and_harms_nobody(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("server.features.doors.subscriptions.STALL_SECONDS", 1.0)

    async def scenario(served: Served) -> None:
        folder, token = await issue(served, "read"), await make_token(served, "read", "Page")
        values = tls_settings(served, folder)
        reading = asyncio.Event()
        reading.set()
        relay = await asyncio.start_server(
            lambda reader, writer: pass_on(served, reader, writer, reading), "127.0.0.1", 0
        )
        port = relay.sockets[0].getsockname()[1]
        topic = "/camera/image/compressed"
        async with (
            relay,
            ros2_peer(served, values | {"connect/endpoints": [f"tls/127.0.0.1:{port}"]}) as peer,
            open_rosbridge(served, token) as socket,
        ):
            page = RosbridgeClient(socket)
            await page.say(op="subscribe", topic=topic)
            await asyncio.to_thread(peer.subscribe, topic, "sensor_msgs/msg/CompressedImage")
            await until(lambda: subscribed(served) == {topic}, "the subscription")
            reading.clear()
            door, number = served.container.doors.doors["ros2"], 0
            while door.clients:
                number += 1
                served.container.doors.see(picture_block(number, 300_000))
                assert (await page.next("publish"))["topic"] == topic
                await asyncio.sleep(0)
            reading.set()

    play_ros2(settings, scenario)


def test_a_flood_of_a_program_is_slowed_down_and_stop_passes(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder, token = await issue(served), await make_token(served, "read", "Page")
        session = await asyncio.to_thread(open_zenoh, {"mode": "client"} | tls_settings(served, folder))
        flooding = True

        def flood() -> None:
            publisher = session.declare_publisher("0/cmd_vel/a/b")
            while flooding:
                publisher.put(bytes(40))

        try:
            async with open_rosbridge(served, token) as socket:
                page = RosbridgeClient(socket)
                work = asyncio.create_task(asyncio.to_thread(flood))
                await until(lambda: refused(served) > 1000, "the flood")
                for _ in range(20):
                    assert (await page.call("/mucat/stop"))["result"] is True
                flooding = False
                await work
        finally:
            flooding = False
            await asyncio.to_thread(session.close)

    play_ros2(settings, scenario)


def test_a_certificate_that_ends_ends_its_connection(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        folder = await issue(served, "read")
        (device,) = (one for one in served.container.access.devices.all() if one.name == "Lab")
        device.ends = time.time() + 3
        async with ros2_peer(served, tls_settings(served, folder)) as peer:
            await asyncio.to_thread(peer.subscribe, "/depth", "std_msgs/msg/Float64")
            await until(lambda: subscribed(served) == {"/depth"}, "the subscription")
            await until(lambda: not served.container.doors.doors["ros2"].clients, "the end")
            assert time.time() >= device.ends

    play_ros2(settings, scenario)


def test_a_message_that_is_too_large_is_not_read() -> None:
    assert read_payload(zenoh.ZBytes(bytes(PAYLOAD_MAX))) == bytes(PAYLOAD_MAX)
    assert read_payload(zenoh.ZBytes(bytes(PAYLOAD_MAX + 1))) is None
    assert read_payload(None) == b""


def subscribed(served: Served) -> set[str]:
    return {
        one.channel.name
        for client in served.container.doors.doors["ros2"].clients
        for one in client.subscriptions.values()
    }


def refused(served: Served) -> int:
    return sum(client.refused for client in served.container.doors.doors["ros2"].clients)


async def steer(peer: Ros2Peer, wheel: Any) -> None:
    vector = peer.type("geometry_msgs/msg/Vector3")
    linear, angular = vector(x=0.5, y=0.25, z=-7.0), vector(x=0.1, y=0.2, z=0.3)
    await asyncio.to_thread(wheel.publish, linear=linear, angular=angular)


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
    served.container.doors.see_health([{"name": "board", "state": "failed", "text": MARK}])
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
        *(picture_block(0, 30_000, topic) for topic in ("picture", "observer", "mask", "balanced")),
    )


async def by_rosbridge(page: RosbridgeClient, topics: Set[str]) -> dict[str, dict[str, Any]]:
    """The newest message of each topic, flat."""
    found: dict[str, dict[str, Any]] = {}
    while found.keys() != topics:
        message = await page.next("publish")
        if message["topic"] in topics and is_wanted(message["topic"], flat := flatten(message["msg"])):
            found[message["topic"]] = flat
    return found


async def by_ros2(peer: Ros2Peer, topics: Set[str]) -> dict[str, dict[str, Any]]:
    """The same at the other door."""
    found: dict[str, dict[str, Any]] = {}
    while found.keys() != topics:
        topic, message = await asyncio.to_thread(peer.received.get, timeout=SECONDS)
        if topic in topics and is_wanted(topic, flat := flatten(message)):
            found[topic] = flat
    return found


def is_wanted(topic: str, message: dict[str, Any]) -> bool:
    """False for the server's own lines and health, of which each door may send others first."""
    expected = {"/rosout": ("msg", "hello"), "/diagnostics": ("status.0.message", MARK)}
    key, value = expected.get(topic, ("", None))
    return message.get(key) == value


def differences(one: dict[str, Any], other: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    """The values that are not equal; of 32 bits, or in JSON, a number may be rounded."""
    pairs = {key: (one.get(key), other.get(key)) for key in one.keys() | other.keys()}
    return {
        key: (first, second)
        for key, (first, second) in pairs.items()
        if first != (pytest.approx(second, rel=1e-6, nan_ok=True) if isinstance(second, float) else second)
    }


def flatten(value: Any, name: str = "") -> dict[str, Any]:
    """The plain values of a message by their path; base64, null and arrays of rosbridge as ROS 2 has them."""
    if is_dataclass(value):
        # Constants are fields here, too.
        names = [one.name for one in fields(value) if one.name.islower() and one.name != "__msgtype__"]
        value = {one: getattr(value, one) for one in names}
    if isinstance(value, numpy.ndarray):
        value = bytes(value) if value.dtype == numpy.uint8 else value.tolist()
    if name == "data" and isinstance(value, str):
        value = base64.b64decode(value)
    if isinstance(value, dict):
        return {
            path: one for key, inner in value.items() for path, one in flatten(inner, join(name, key)).items()
        }
    if isinstance(value, list):
        return {name: len(value)} | flatten(dict(enumerate(value)), name)
    return {name: nan if value is None else value}


def join(name: str, key: object) -> str:
    return f"{name}.{key}" if name else str(key)


def key_of(session: zenoh.Session, name: str) -> str:
    """The key of the robot's topic or service with this name, by its token."""
    pattern = f"@ros2_lv/0/*/*/*/*/%/%/mucat/{name}/*/*/*"
    (reply,) = session.liveliness().get(pattern)
    assert reply.ok is not None
    return "/".join(["0", name.strip("%").replace("%", "/"), *str(reply.ok.key_expr).split("/")[10:12]])


def answers(session: zenoh.Session, key: str, payload: bytes) -> list[bytes]:
    """The answers to a call."""
    replies = session.get(key, payload=payload, timeout=1.0)
    return [one.ok.payload.to_bytes() for one in replies if one.ok is not None]


async def gets_something(values: dict[str, Any], seconds: float = 2.0) -> bool:
    """True if a session with these settings sees the robot's node within this time."""

    def look() -> bool:
        try:
            session = open_zenoh({"mode": "client", "connect/timeout_ms": int(seconds * 1000)} | values)
        except zenoh.ZError:
            return False
        try:
            return any(one.ok for one in session.liveliness().get("@ros2_lv/**", timeout=seconds))
        finally:
            session.close()  # type: ignore[no-untyped-call]

    return await asyncio.to_thread(look)


async def pass_on(
    served: Served, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, reading: asyncio.Event
) -> None:
    """Pass bytes on between a program and the door, to the program only while `reading` is set."""
    there, back = await asyncio.open_connection(*served.container.ros2.address)

    async def pump(
        source: asyncio.StreamReader, sink: asyncio.StreamWriter, gate: asyncio.Event | None
    ) -> None:
        with suppress(OSError):
            while data := await source.read(4096):
                if gate is not None:
                    await gate.wait()
                sink.write(data)
                await sink.drain()

    try:
        await asyncio.gather(pump(reader, back, None), pump(there, writer, reading))
    finally:
        for one in (back, writer):
            one.transport.abort()
