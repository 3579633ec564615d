"""Programs at the doors of rosbridge and Foxglove that send what no program should, or whose access ends."""

import asyncio
import json
from collections.abc import Callable
from contextlib import suppress
from struct import pack
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from robot_runtime.contract.commands import http_commands
from server.driving.arbiter import ControlArbiter
from server.features.doors.commands import RELEASE, STOP, TAKE
from server.platform.settings import Settings
from tests.server.features.doors.rig import (
    OPEN,
    RosbridgeClient,
    TokenTime,
    acts_of,
    make_token,
    open_rosbridge,
)
from tests.server.features.doors.test_foxglove import next_op, open_foxglove
from tests.server.serving import Served
from tests.server.waiting import SECONDS, until

Open = Callable[[Served, str | None], connect]
TWIST = {"linear": {"x": 0.5, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
NAMES = [*(cls.policy.name for cls in http_commands() if cls.policy.need is not None), TAKE, RELEASE, STOP]
DOORS = pytest.mark.parametrize("open_door", [open_rosbridge, open_foxglove], ids=["rosbridge", "foxglove"])
HOSTILE: tuple[str | bytes, ...] = (
    "[" * 4000,
    '{"op":' * 600,
    '{"op": "subscribe", "topic": ' + "[" * 1900 + "]" * 1900 + "}",
    '{"op": "subscribe", "topic": "/depth", "id": "' + "x" * 3000 + '"}',
    '{"op": "subscribe", "id": ' + "9" * 4000 + "}",
    '{"op": "' + "y" * 4000 + '"}',
    '{"op": 1e400}',
    '{"op": "subscribe", "topic": "/depth", "throttle_rate": NaN}',
    '{"op": "subscribe", "topic": "\\ud800"}',
    '{"op": {"$ref": "#"}}',
    # CBOR: its own tag; a tag for a number of any size; an array of 2**64 - 1 items; text without an end.
    b"\xd9\xd9\xf7\xa0",
    b"\xc2\x5b\xff\xff\xff\xff\xff\xff\xff\xff",
    b"\x9b\xff\xff\xff\xff\xff\xff\xff\xff",
    b"\x7f" * 100,
    b"\x89PNG\r\n\x1a\n",
)


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return settings.with_section(OPEN)


async def is_answered(socket: ClientConnection) -> bool:
    """Return True where the door answers a question."""
    if socket.subprotocol is None:
        return bool((await RosbridgeClient(socket).call("/rosapi/get_time"))["result"])
    await socket.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "there"}))
    return bool((await next_op(socket, "parameterValues"))["id"] == "there")


async def closing_code(socket: ClientConnection) -> int | None:
    """Read until the door ends the connection; its reason as a number."""
    with suppress(ConnectionClosed):
        while True:
            await socket.recv()
    return socket.close_code


async def take_control(socket: ClientConnection) -> None:
    """Ask for control."""
    if socket.subprotocol is None:
        assert (await RosbridgeClient(socket).call("/mucat/take_control"))["result"] is True
        return
    await call(socket, await list_services(socket), TAKE)


async def list_services(socket: ClientConnection) -> dict[str, int]:
    """Return the numbers of the services at Foxglove's door."""
    listed = (await next_op(socket, "advertiseServices"))["services"]
    return {service["name"].removeprefix("/mucat/"): service["id"] for service in listed}


async def call(socket: ClientConnection, services: dict[str, int], name: str) -> None:
    """Call a service without fields."""
    await socket.send(pack("<BIII", 2, services[name], 1, 4) + b"json{}")


async def send_twist(socket: ClientConnection) -> None:
    """Publish the sticks' position."""
    if socket.subprotocol is None:
        await RosbridgeClient(socket).say(op="publish", topic="/cmd_vel", msg=TWIST)
        return
    channel = {"id": 4, "topic": "/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
    await socket.send(json.dumps({"op": "advertise", "channels": [channel]}))
    await socket.send(pack("<BI", 1, 4) + json.dumps(TWIST).encode())


@DOORS
async def test_a_hostile_message_is_refused_in_words_and_the_door_stays_open(
    open_door: Open, served: Served
) -> None:
    async with open_door(served, await make_token(served)) as socket:
        for message in HOSTILE:
            await socket.send(message)
            refused: dict[str, Any] = await next_op(socket, "status")
            assert (refused.get("msg") or refused["message"]).endswith((".", "?")), message[:60]
            assert await is_answered(socket)
    assert [name for name, _ in served.runtime.asked if name != "there"] == []


@DOORS
@pytest.mark.parametrize("message", ["[" + "0," * 3000 + "0]", b"\x01" + bytes(5000)], ids=["text", "bytes"])
async def test_a_message_that_is_too_large_ends_its_connection(
    open_door: Open, message: str | bytes, served: Served
) -> None:
    token = await make_token(served)
    async with open_door(served, token) as socket, open_door(served, token) as other:
        await socket.send(message)
        assert await closing_code(socket) == 1009
        assert await is_answered(other)


@DOORS
async def test_a_token_that_ends_while_its_program_drives_ends_control(
    open_door: Open, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    await served.api.post("/control/release")
    token = await make_token(served)
    lasting = TokenTime(served, monkeypatch, "Program")
    async with open_door(served, token) as socket:
        await take_control(socket)
        await until(lambda: served.get(ControlArbiter).lease.holder is not None, "control")
        await send_twist(socket)
        await until(lambda: served.runtime.driven, "the command")
        assert await is_answered(socket)
        lasting.end()
        assert await closing_code(socket) == 1008
    await until(lambda: served.get(ControlArbiter).lease.holder is None, "control to be free")
    async with open_door(served, token) as socket:
        with pytest.raises(ConnectionClosed):
            await is_answered(socket)


@DOORS
async def test_a_viewers_token_stops_the_robot_and_does_nothing_else(open_door: Open, served: Served) -> None:
    await served.api.post("/control/release")
    token = await make_token(served, "read", "Reader")
    async with open_door(served, token) as socket:
        services = {} if socket.subprotocol is None else await list_services(socket)
        await send_twist(socket)
        refused: dict[str, Any] = await next_op(socket, "status")
        assert "role of an operator" in (refused.get("msg") or refused["message"])
        for name in NAMES:
            if socket.subprotocol is None:
                await RosbridgeClient(socket).call(f"/mucat/{name}")
            else:
                await call(socket, services, name)
                assert await is_answered(socket)
    await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")
    assert {name for name, _ in served.runtime.asked if name != "there"} == {"stop"}
    assert served.runtime.driven == []
    assert served.get(ControlArbiter).lease.holder is None
    titles = {TAKE: "Take control", RELEASE: "Release control", STOP: "STOP"}
    expected = {(titles.get(name, name), "refused") for name in set(NAMES) - {STOP, RELEASE}}
    expected |= {("STOP", "done"), ("Release control", "done")}
    # What the runtime has answered is written a moment later.
    async with asyncio.timeout(SECONDS):
        while missing := expected - {act[1:] for act in await acts_of(served) if act[0] == "Reader"}:
            await asyncio.sleep(0.01)
    assert not missing
