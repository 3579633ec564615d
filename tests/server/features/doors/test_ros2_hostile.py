"""Programs of ROS 2 that send nonsense or too much, or read nothing: with the real Zenoh."""

import asyncio
import select
import socket
from contextlib import ExitStack, suppress

import pytest
import zenoh

from server.container import Container
from server.features.doors import ros2_door
from server.features.doors.house import Doors
from server.features.doors.ros2_door import Ros2Door
from server.features.doors.ros2_messages import PAYLOAD_MAX
from server.features.doors.ros2_names import Endpoint
from server.features.doors.ros2_node import Incoming, read_payload
from server.features.doors.ros2_session import WAITING_MAX, Ros2Session
from server.features.doors.twist import CMD_VEL, STOP_TOPIC
from server.platform.settings import Settings
from tests.server.blocks import picture_block
from tests.server.features.doors.fuzz_rig import join_door
from tests.server.features.doors.rig import (
    RosbridgeClient,
    hurry,
    make_token,
    open_rosbridge,
)
from tests.server.features.doors.ros2_rig import (
    doors_of,
    issue,
    open_zenoh,
    refused,
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


async def test_what_is_not_valid_is_refused_and_counted(served: Served) -> None:
    folder = await issue(served)
    session = await asyncio.to_thread(open_zenoh, {"mode": "client"} | tls_settings(served, folder))
    try:
        names = ("%cmd_vel", "%mucat%arm")
        twist, arm = [await asyncio.to_thread(key_of, session, name) for name in names]
        cut, filled = b"\0\1\0\0", b"\0\1\0\0" + b"\xff" * 48
        bad = [b"", b"\0", cut, filled, b"\7\7\0\0" + bytes(48), bytes(5000), bytes(10**6)]
        for payload in bad:
            await put(session, twist, payload)
        await put(session, "0/cmd_vel/geometry_msgs::msg::dds_::TwistStamped_/RIHS01_0", bytes(60))
        await until(lambda: refused(served) >= len(bad), "the refusals")
        for payload in bad[:4]:
            assert not await asyncio.to_thread(answers, session, arm, payload)
        assert served.runtime.driven == []
        await put(session, "0/mucat/stop/std_msgs::msg::dds_::Bool_/RIHS01_0", b"")
        await until(lambda: ("stop", {}) in served.runtime.asked, "STOP by whatever message")
        stop = await asyncio.to_thread(key_of, session, "%mucat%stop", "SS")
        await asyncio.to_thread(answers, session, stop, bytes(PAYLOAD_MAX + 1))
        asked = [name for name, _ in served.runtime.asked if name != "there"]
        assert asked == ["stop", "stop"]
        await until(lambda: refused(served) >= len(bad) + 4, "the calls to be refused")
        (client,) = await doors_of(served)
        assert client["refused"] >= len(bad) + 4
    finally:
        await asyncio.to_thread(session.close)


async def test_a_program_that_reads_nothing_is_disconnected_and_harms_nobody(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    hurry(monkeypatch, "Lab")

    async with serve(settings) as served:
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
            door, number = served.get(Doors).doors["ros2"], 0
            while door.clients:
                number += 1
                served.get(Doors).see(picture_block(number, 300_000))
                assert (await page.next("publish"))["topic"] == topic
                await asyncio.sleep(0)
            reading.set()


async def test_a_flood_of_a_program_is_slowed_down_and_stop_passes(served: Served) -> None:
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
        # Megabytes may lie before the door, which reads them slowly; Zenoh waits 10 s to say goodbye.
        with suppress(zenoh.ZError):
            await asyncio.to_thread(session.close)


async def test_of_many_connections_at_once_no_more_than_the_limit_are_let_in(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ros2_door, "HANDSHAKE_SECONDS", 10 * SECONDS)
    refused_count = 50

    async with serve(settings) as served:
        with ExitStack() as stack:
            # They wait in the listener's backlog, since the door does not run meanwhile.
            connections = [
                stack.enter_context(socket.create_connection(served.get(Ros2Door).address))
                for _ in range(ros2_door.STRANGERS_MAX + refused_count)
            ]
            for connection in connections:
                connection.setblocking(False)

            def ended() -> int:
                return len(select.select(connections, [], [], 0)[0])

            await until(lambda: ended() >= refused_count, "the others to be refused")
            assert ended() == refused_count
            assert served.get(Doors).doors["ros2"].strangers == ros2_door.STRANGERS_MAX


async def test_a_subscriber_that_comes_while_its_program_is_disconnected_gets_nothing(served: Served) -> None:
    container = served.container
    door = container.services.get(Doors).doors["ros2"]
    with join_door(container, "ros2") as (client, pilot, commands):

        async def writable() -> None:
            pass

        session = Ros2Session(client, pilot, container.services.get(Doors), commands, writable)
        (topic, *_) = door.publisher.channels
        session.match(Endpoint("MP", topic, "", "", 1, False), True)
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert door.publisher.sources() == frozenset()


async def test_of_a_flood_of_stops_as_many_wait_as_of_other_messages(container: Container) -> None:
    with join_door(container, "ros2") as (client, pilot, commands):

        async def writable() -> None:
            pass

        session = Ros2Session(client, pilot, container.services.get(Doors), commands, writable)
        drive, stop = (Endpoint("MS", name, "", "", 1, False) for name in (CMD_VEL, STOP_TOPIC))
        for _ in range(1000):
            session.receive(Incoming(drive, True, b"", b""))
        for _ in range(1000):
            session.receive(Incoming(stop, True, b"", b""))
        await asyncio.sleep(0)
        waiting = [session._waiting.get_nowait() for _ in range(session._waiting.qsize())]
        assert [call.endpoint for call in waiting] == [drive] * WAITING_MAX + [stop] * WAITING_MAX
        assert client.refused == 2 * (1000 - WAITING_MAX)


def test_a_message_that_is_too_large_is_not_read() -> None:
    assert read_payload(zenoh.ZBytes(bytes(PAYLOAD_MAX))) == bytes(PAYLOAD_MAX)
    assert read_payload(zenoh.ZBytes(bytes(PAYLOAD_MAX + 1))) is None
    assert read_payload(None) == b""


def key_of(session: zenoh.Session, name: str, kind: str = "*") -> str:
    """Return the key of the robot's topic or service with this name, by its token."""
    pattern = f"@ros2_lv/0/*/*/*/{kind}/%/%/mucat/{name}/*/*/*"
    (reply,) = session.liveliness().get(pattern)
    assert reply.ok is not None
    return "/".join(["0", name.strip("%").replace("%", "/"), *str(reply.ok.key_expr).split("/")[10:12]])


async def put(session: zenoh.Session, key: str, payload: bytes) -> None:
    """Publish a message that Zenoh does not drop where its queue is full, as it soon does by itself."""
    block = zenoh.CongestionControl.BLOCK
    await asyncio.to_thread(session.put, key, payload, congestion_control=block)


def answers(session: zenoh.Session, key: str, payload: bytes) -> list[bytes]:
    """Return the answers to a call."""
    replies = session.get(key, payload=payload, timeout=1.0)
    return [reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None]


async def pass_on(
    served: Served, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, reading: asyncio.Event
) -> None:
    """Pass bytes on between a program and the door, to the program only while `reading` is set."""
    there, back = await asyncio.open_connection(*served.get(Ros2Door).address)

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
        for stream in (back, writer):
            stream.transport.abort()
