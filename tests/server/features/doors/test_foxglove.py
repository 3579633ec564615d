import json
from struct import pack, unpack_from
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from robot_runtime.contract.documents import Control
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.container import Container
from server.driving.arbiter import ControlArbiter
from server.features.doors.channels import read_samples
from server.features.doors.foxglove import FoxgloveSession
from server.features.doors.foxglove_services import advertise_services
from server.features.doors.house import Doors
from server.features.doors.session import INVALID_MAX
from server.platform.settings import Settings
from tests.server.blocks import debug_block
from tests.server.features.doors.fuzz_rig import join_door
from tests.server.features.doors.rig import (
    OPEN,
    address,
    imu,
    make_token,
    rows_block,
    truth,
)
from tests.server.serving import Served
from tests.server.waiting import SOCKET_LIMITS, until

V1 = "foxglove.websocket.v1"


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return settings.with_section(OPEN)


def open_foxglove(served: Served, token: str | None, protocol: str = V1) -> connect:
    protocols: list[Any] = [protocol]
    return connect(
        address(served, "foxglove", token),
        subprotocols=protocols,
        max_size=None,
        compression=None,
        **SOCKET_LIMITS,
    )


async def next_op(socket: ClientConnection, op: str) -> dict[str, Any]:
    """Return the next message of text with this op."""
    async for message in socket:
        if isinstance(message, str) and (answer := json.loads(message))["op"] == op:
            assert isinstance(answer, dict)
            return answer
    raise AssertionError(f"the socket was closed before {op} came")


async def next_message(socket: ClientConnection) -> tuple[int, int, Any]:
    """Return the next message of a channel: subscription, time (ns) and content."""
    async for message in socket:
        if isinstance(message, bytes) and message[0] == 1:
            number, time = unpack_from("<IQ", message, 1)
            return number, time, json.loads(message[13:])
    raise AssertionError("the socket was closed")


async def subscribe(socket: ClientConnection, *topics: str) -> dict[str, int]:
    """Subscribe to these topics; their subscriptions' numbers."""
    channels = {
        channel["topic"]: channel["id"] for channel in (await next_op(socket, "advertise"))["channels"]
    }
    numbers = {topic: index for index, topic in enumerate(topics)}
    listed = [{"id": number, "channelId": channels[topic]} for topic, number in numbers.items()]
    await socket.send(json.dumps({"op": "subscribe", "subscriptions": listed}))
    await socket.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "there"}))
    await next_op(socket, "parameterValues")
    return numbers


@pytest.mark.parametrize("protocol", ["foxglove.sdk.v1", V1])
async def test_samples_come_with_our_axes_and_utc(protocol: str, served: Served) -> None:
    async with open_foxglove(served, await make_token(served, "read"), protocol) as socket:
        assert socket.subprotocol == protocol
        assert "services" in (await next_op(socket, "serverInfo"))["capabilities"]
        numbers = await subscribe(socket, "/depth", "/pose", "/log")
        now = served.container.clock.now()
        turned = (0.8, 0.0, 0.0, 0.6)
        doors = served.get(Doors)
        doors.see(rows_block("truth", 0, (now, truth((1.0, 2.0, 0.7), turned))))
        depth = Depth(time=2_000_000, depth=0.7, pressure=108_000, temperature=18.5)
        doors.see(rows_block("depth", 0, (now, depth)))
        doors.see(rows_block("imu", 0, (now, imu(turned))))
        doors.see(debug_block(0, "hello", start=now))
        results: dict[int, Any] = {}
        while len(results) < 3:
            number, time, message = await next_message(socket)
            # The log has lines of the server, too.
            if number != numbers["/log"] or message["message"] == "hello":
                results[number] = message
            assert abs(time - doors.utc_ns()) < 60e9
        assert results[numbers["/depth"]]["depth"] == pytest.approx(0.7)
        assert results[numbers["/depth"]]["board_time"] == pytest.approx(2.0)
        pose = results[numbers["/pose"]]
        assert pose["frame_id"] == "ned"
        assert pose["pose"]["position"] == pytest.approx({"x": 1.0, "y": 2.0, "z": 0.7})
        assert pose["pose"]["orientation"]["z"] == pytest.approx(0.6, abs=1e-4)
        assert results[numbers["/log"]]["message"] == "hello"


async def test_without_a_token_or_a_known_subprotocol_it_is_refused(served: Served) -> None:
    token = await make_token(served)
    for given, protocols in ((None, [V1]), ("mucat_wrong", [V1]), (token, [])):
        offered: list[Any] = [*protocols]
        async with connect(
            address(served, "foxglove", given),
            subprotocols=offered or None,
            compression=None,
            **SOCKET_LIMITS,
        ) as socket:
            with pytest.raises(ConnectionClosed) as closed:
                await socket.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1008


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
    '{"op": "advertise", "channels": [{"id": 1, "topic": "/cmd_vel", "encoding": "cdr", "schemaName": "a"}]}',
    '{"op": "setParameters", "parameters": []}',
    pack("<BI", 1, 5) + b"{}",
)


async def test_an_invalid_message_is_answered_in_words(served: Served) -> None:
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


@pytest.mark.parametrize(("encoding", "payload"), [(b"cdr", b"\0"), (b"json", b"{"), (b"json", b"7")])
async def test_stop_is_carried_out_whatever_its_request_is(
    served: Served, encoding: bytes, payload: bytes
) -> None:
    (stop,) = (service["id"] for service in advertise_services() if service["name"] == "/mucat/stop")

    async with open_foxglove(served, await make_token(served, "read")) as socket:
        await socket.send(pack("<BIII", 2, stop, 1, len(encoding)) + encoding + payload)
        await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")


async def test_a_subscription_before_one_that_is_refused_holds(served: Served) -> None:
    async with open_foxglove(served, await make_token(served, "read")) as socket:
        listed = (await next_op(socket, "advertise"))["channels"]
        (camera,) = (channel["id"] for channel in listed if channel["topic"] == "/camera")
        both = [{"id": 1, "channelId": camera}, {"id": 2, "channelId": 999}]
        await socket.send(json.dumps({"op": "subscribe", "subscriptions": both}))
        assert "no channel 999" in (await next_op(socket, "status"))["message"]
        await served.heard("picture")
        await socket.send(json.dumps({"op": "unsubscribe", "subscriptionIds": [1, "x"]}))
        await next_op(socket, "status")
        await until(lambda: not served.runtime.is_heard("picture"), "the picture to be left")


def parameters_block(number: int, **values: float) -> Block:
    """Return the document of these parameters."""
    listed = [{"name": name, "type": "number", "value": value} for name, value in values.items()]
    data = json.dumps([{"time": 1.0, "parameters": listed}]).encode()
    return Block.of(BY_NAME["parameters"], 1, number, data)


async def test_a_change_is_sent_also_where_another_parameter_is_watched_before(container: Container) -> None:
    doors = container.services.get(Doors)
    with join_door(container, "foxglove") as (client, pilot, commands):
        session = FoxgloveSession(client, pilot, doors, doors.doors["foxglove"], commands)
        for number, (watched, value) in enumerate((("a", 1), ("b", 2))):
            doors.see(parameters_block(number, a=value, b=0))
            session.act(json.dumps({"op": "subscribeParameterUpdates", "parameterNames": [watched]}))
        (changes,) = session._parameter_changes()
    assert json.loads(changes)["parameters"] == [{"name": "a", "value": 2, "type": "float64"}]


async def test_a_parameter_that_was_set_has_its_new_value_before_the_next_document(served: Served) -> None:
    served.runtime.publish(parameters_block(0, a=1.5, b=0))
    await until(lambda: served.get(Doors).parameters(), "the parameters")
    await served.api.post("/control/release")
    async with open_foxglove(served, await make_token(served)) as socket:
        (take,) = (
            service["id"] for service in advertise_services() if service["name"] == "/mucat/take_control"
        )
        await socket.send(pack("<BIII", 2, take, 1, 4) + b"json")
        async for message in socket:
            if isinstance(message, bytes) and message[0] == 3:
                break
        served.runtime.answer = {"changed": {"a": [1.5, 3]}}
        asked = {"op": "setParameters", "parameters": [{"name": "a", "value": 3}], "id": "set"}
        await socket.send(json.dumps(asked))
        three = [{"name": "a", "value": 3, "type": "float64"}]
        assert (await next_op(socket, "parameterValues"))["parameters"] == three
        await socket.send(json.dumps({"op": "getParameters", "parameterNames": ["a"], "id": "get"}))
        assert (await next_op(socket, "parameterValues"))["parameters"] == three


def test_a_picture_that_is_cut_off_is_a_damaged_block() -> None:
    with pytest.raises(ValueError, match="picture is damaged"):
        read_samples(Block.of(BY_NAME["picture"], 1, 0, bytes(7)))


async def test_time_never_goes_back(served: Served) -> None:
    """Samples come later than they were taken, and health between them has the time at which it is sent."""

    async with open_foxglove(served, await make_token(served, "read")) as socket:
        await subscribe(socket)
        times: list[int] = []
        for number in range(3):
            taken = served.container.clock.now() - 0.2
            served.get(Doors).see_health([])
            values: dict[str, Any] = dict.fromkeys(Control.wires, 0.0)
            served.get(Doors).see(rows_block("control", number, (taken, Control(**values))))
            while len(times) < 2 * (number + 1):
                message = await socket.recv()
                if isinstance(message, bytes) and message[0] == 2:
                    times.append(unpack_from("<Q", message, 1)[0])
        assert times == sorted(times)
        assert abs(times[-1] - served.get(Doors).utc_ns()) < 60e9


async def test_a_topic_that_programs_may_not_publish_is_refused_with_its_first_message(
    served: Served,
) -> None:
    """Foxglove and Lichtblick advertise three such topics for each 3D panel, again and again."""

    async with open_foxglove(served, await make_token(served)) as socket:
        goal = {"topic": "/move_base_simple/goal", "encoding": "json", "schemaName": "a"}
        stop = {"topic": "/mucat/stop", "encoding": "json", "schemaName": "std_msgs/Empty"}
        for number in range(INVALID_MAX + 1):
            both = [goal | {"id": number}, stop | {"id": 1000 + number}]
            await socket.send(json.dumps({"op": "advertise", "channels": both}))
            if number > 0:
                gone = [number - 1, 999 + number]
                await socket.send(json.dumps({"op": "unadvertise", "channelIds": gone}))
        await socket.send(pack("<BI", 1, INVALID_MAX) + b"{}")
        assert "and not /move_base_simple/goal" in (await next_op(socket, "status"))["message"]
        await socket.send(pack("<BI", 1, 0) + b"{}")
        assert "is not advertised" in (await next_op(socket, "status"))["message"]
        await socket.send(pack("<BI", 1, 1000 + INVALID_MAX) + b"{}")
        await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")


async def test_a_twist_drives_with_control_alone(served: Served) -> None:
    await served.api.post("/control/release")
    async with open_foxglove(served, await make_token(served)) as socket:
        services = {
            service["name"]: service["id"]
            for service in (await next_op(socket, "advertiseServices"))["services"]
        }
        channel = {"id": 4, "topic": "/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
        await socket.send(json.dumps({"op": "advertise", "channels": [channel]}))
        twist = json.dumps({"linear": {"x": 0.5, "y": 0.25, "z": 0}, "angular": {"x": 0, "y": 0, "z": 1}})
        await socket.send(pack("<BI", 1, 4) + twist.encode())
        assert "Take control" in (await next_op(socket, "status"))["message"]
        assert served.runtime.driven == []
        await socket.send(pack("<BIII", 2, services["/mucat/take_control"], 1, 4) + b"json{}")
        await until(lambda: served.get(ControlArbiter).lease.holder is not None, "control")
        await socket.send(pack("<BI", 1, 4) + twist.encode())
        await until(lambda: served.runtime.driven, "the command")
        assert served.runtime.driven[0]["axes"] == [0.5, -0.25, 0.0, 0.0, 0.0, -1.0]


SIMPLE = ("boolean", "integer", "number", "string")


def is_plain(schema: dict[str, Any]) -> bool:
    """Return True where Foxglove's parser reads this schema of a field."""
    if schema["type"] == "object":
        return all(is_plain(inner) for inner in schema["properties"].values())
    if schema["type"] == "array":
        return schema["items"]["type"] != "array" and is_plain(schema["items"])
    return schema["type"] in SIMPLE


@pytest.mark.parametrize("service", advertise_services(), ids=lambda item: item["name"])
def test_foxglove_reads_the_schemas_of_each_service(service: dict[str, Any]) -> None:
    for of in ("request", "response"):
        schema = json.loads(service[of]["schema"])
        assert schema["type"] == "object"
        assert is_plain(schema)
        assert service[f"{of}Schema"] == service[of]["schema"]


def test_a_schema_names_the_fields_of_its_command() -> None:
    (loop,) = (service for service in advertise_services() if service["name"] == "/mucat/loop")
    fields = json.loads(loop["request"]["schema"])["properties"]
    assert {"name", "on", "controller", "set_point"} <= fields.keys()
    assert fields["on"]["type"] == "boolean"
