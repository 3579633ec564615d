import json
from struct import pack, unpack_from
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from robot_runtime.contract.packets import Depth
from server.features.doors.session import INVALID_MAX
from server.platform.settings import Settings
from tests.server.blocks import debug_block
from tests.server.features.doors.rig import (
    address,
    imu,
    make_token,
    play_open,
    rows_block,
    truth,
)
from tests.server.serving import Served
from tests.server.waiting import until

V1 = "foxglove.websocket.v1"


def open_foxglove(served: Served, token: str | None, protocol: str = V1) -> connect:
    protocols: list[Any] = [protocol]
    return connect(
        address(served, "foxglove", token), subprotocols=protocols, max_size=None, compression=None
    )


async def next_op(socket: ClientConnection, op: str) -> dict[str, Any]:
    """The next message of text with this op."""
    async for message in socket:
        if isinstance(message, str) and (found := json.loads(message))["op"] == op:
            assert isinstance(found, dict)
            return found
    raise AssertionError(f"the socket was closed before {op} came")


async def next_message(socket: ClientConnection) -> tuple[int, int, Any]:
    """The next message of a channel: subscription, time (ns) and content."""
    async for message in socket:
        if isinstance(message, bytes) and message[0] == 1:
            number, time = unpack_from("<IQ", message, 1)
            return number, time, json.loads(message[13:])
    raise AssertionError("the socket was closed")


async def subscribe(socket: ClientConnection, *topics: str) -> dict[str, int]:
    """Subscribe to these topics; their subscriptions' numbers."""
    channels = {one["topic"]: one["id"] for one in (await next_op(socket, "advertise"))["channels"]}
    numbers = {topic: place for place, topic in enumerate(topics)}
    listed = [{"id": number, "channelId": channels[topic]} for topic, number in numbers.items()]
    await socket.send(json.dumps({"op": "subscribe", "subscriptions": listed}))
    await socket.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "there"}))
    await next_op(socket, "parameterValues")
    return numbers


@pytest.mark.parametrize("protocol", ["foxglove.sdk.v1", V1])
def test_samples_come_with_our_axes_and_utc(settings: Settings, protocol: str) -> None:
    async def scenario(served: Served) -> None:
        async with open_foxglove(served, await make_token(served, "read"), protocol) as socket:
            assert socket.subprotocol == protocol
            assert "assets" in (await next_op(socket, "serverInfo"))["capabilities"]
            numbers = await subscribe(socket, "/depth", "/pose", "/log")
            now = served.container.clock.now()
            turned = (0.8, 0.0, 0.0, 0.6)
            doors = served.container.doors
            doors.see(rows_block("truth", 0, (now, truth((1.0, 2.0, 0.7), turned))))
            depth = Depth(time=2_000_000, depth=0.7, pressure=108_000, temperature=18.5)
            doors.see(rows_block("depth", 0, (now, depth)))
            doors.see(rows_block("imu", 0, (now, imu(turned))))
            doors.see(debug_block(0, "hello", start=now))
            found: dict[int, Any] = {}
            while len(found) < 3:
                number, time, message = await next_message(socket)
                found[number] = message
                assert abs(time - doors.utc_ns()) < 60e9
            assert found[numbers["/depth"]]["depth"] == pytest.approx(0.7)
            assert found[numbers["/depth"]]["board_time"] == pytest.approx(2.0)
            pose = found[numbers["/pose"]]
            assert pose["frame_id"] == "ned"
            assert pose["pose"]["position"] == pytest.approx({"x": 1.0, "y": 2.0, "z": 0.7})
            assert pose["pose"]["orientation"]["z"] == pytest.approx(0.6, abs=1e-4)
            assert found[numbers["/log"]]["message"] == "hello"

    play_open(settings, scenario)


def test_without_a_token_or_a_known_subprotocol_it_is_refused(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        token = await make_token(served)
        for given, protocols in ((None, [V1]), ("mucat_wrong", [V1]), (token, [])):
            offered: list[Any] = [*protocols]
            async with connect(
                address(served, "foxglove", given), subprotocols=offered or None, compression=None
            ) as socket:
                with pytest.raises(ConnectionClosed) as closed:
                    await socket.recv()
                assert closed.value.rcvd is not None
                assert closed.value.rcvd.code == 1008

    play_open(settings, scenario)


INVALID: tuple[str | bytes, ...] = (
    *(
        "",
        "{",
        "[]",
        "7",
        '{"op": 7}',
        '{"op": "fly"}',
        '{"op": "subscribe"}',
        b"",
        b"\x09",
        b"\x01",
        b"\x02",
    ),
    '{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99999}]}',
    '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]}',
    '{"op": "advertise", "channels": [{"id": 1, "topic": "/depth", "encoding": "json", "schemaName": "a"}]}',
    '{"op": "advertise", "channels": [{"id": 1, "topic": "/cmd_vel", "encoding": "cdr", "schemaName": "a"}]}',
    '{"op": "setParameters", "parameters": []}',
    '{"op": "fetchAsset", "uri": 7, "requestId": 1}',
    pack("<BI", 1, 5) + b"{}",
)


def test_an_invalid_message_is_answered_in_words(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with open_foxglove(served, await make_token(served)) as socket:
            for message in INVALID:
                await socket.send(message)
                assert (await next_op(socket, "status"))["message"].endswith("."), message
                await socket.send(json.dumps({"op": "getParameters", "parameterNames": []}))
            call = pack("<BIII", 2, 77, 3, 4) + b"json{}"
            await socket.send(call)
            failed = await next_op(socket, "serviceCallFailure")
            assert (failed["serviceId"], failed["callId"]) == (77, 3)
            for _ in range(INVALID_MAX):
                await socket.send("{")
            with pytest.raises(ConnectionClosed):
                await next_op(socket, "never")

    play_open(settings, scenario)


def test_a_twist_drives_with_control_alone(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        await served.api.post("/control/release")
        async with open_foxglove(served, await make_token(served)) as socket:
            services = {
                one["name"]: one["id"] for one in (await next_op(socket, "advertiseServices"))["services"]
            }
            channel = {"id": 4, "topic": "/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
            await socket.send(json.dumps({"op": "advertise", "channels": [channel]}))
            twist = json.dumps({"linear": {"x": 0.5, "y": 0.25, "z": 0}, "angular": {"x": 0, "y": 0, "z": 1}})
            await socket.send(pack("<BI", 1, 4) + twist.encode())
            assert "Take control" in (await next_op(socket, "status"))["message"]
            assert served.runtime.driven == []
            await socket.send(pack("<BIII", 2, services["/mucat/take_control"], 1, 4) + b"json{}")
            await until(lambda: served.container.arbiter.lease.holder is not None, "control")
            await socket.send(pack("<BI", 1, 4) + twist.encode())
            await until(lambda: served.runtime.driven, "the command")
            assert served.runtime.driven[0]["axes"] == [0.5, -0.25, 0.0, 0.0, 0.0, -1.0]

    play_open(settings, scenario)
