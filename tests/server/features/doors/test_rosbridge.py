import asyncio
import base64
import json
from math import asin, atan2, cos, sin
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

import server.stream.bridge as bridge_module
from robot_runtime.contract.packets import Beacon, Depth
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.driving.arbiter import ControlArbiter
from server.features.doors.config import DoorsConfig
from server.features.doors.house import Doors
from server.features.doors.session import INVALID_MAX
from server.platform.settings import Settings
from tests.server.blocks import debug_block, picture_block, state_block
from tests.server.features.doors.rig import (
    OPEN,
    RosbridgeClient,
    acts_of,
    hurry,
    imu,
    make_token,
    open_rosbridge,
    rows_block,
    truth,
)
from tests.server.serving import Served, next_text, serve
from tests.server.waiting import SECONDS, until


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return settings.with_section(OPEN)


async def test_a_door_is_closed_unless_the_configuration_opens_it(settings: Settings) -> None:
    async with serve(settings.with_section(DoorsConfig(foxglove=True))) as served:
        token = await make_token(served)
        with pytest.raises(InvalidStatus):
            async with open_rosbridge(served, token):
                pass
        (rosbridge, foxglove, _) = (await served.api.get("/doors")).json()
        assert (rosbridge["open"], foxglove["open"]) == (False, True)


async def test_without_an_open_door_the_feature_is_off(settings: Settings) -> None:
    async with serve(settings.with_section(DoorsConfig())) as served:
        with pytest.raises(InvalidStatus):
            async with open_rosbridge(served, await make_token(served)):
                pass
        assert (await served.api.get("/doors")).status_code == 404
        async with served.connect() as socket:
            assert "doors" not in (await next_text(socket, "hello"))["features"]


async def test_a_token_in_the_address_or_in_the_first_message_signs_in(served: Served) -> None:
    token = await make_token(served, "read", "Reader")
    async with open_rosbridge(served, token, origin="http://else.where") as socket:
        client = RosbridgeClient(socket)
        assert (await client.call("/rosapi/get_time"))["result"] is True
        (rosbridge, *_) = (await served.api.get("/doors")).json()
        assert [(client["name"], client["role"]) for client in rosbridge["clients"]] == [("Reader", "viewer")]
    async with open_rosbridge(served, None) as socket:
        client = RosbridgeClient(socket)
        await client.say(op="auth", mac=token, client="", dest="", rand="", t=0, level="", end=0)
        assert (await client.call("rosapi/get_time"))["result"] is True
    for first in ({"op": "auth", "mac": "mucat_wrong"}, {"op": "subscribe", "topic": "/depth"}):
        async with open_rosbridge(served, None) as socket:
            await socket.send(json.dumps(first))
            with pytest.raises(ConnectionClosed) as closed:
                await socket.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1008
    async with open_rosbridge(served, "mucat_wrong") as socket:
        await socket.send(json.dumps({"op": "publish", "topic": "/mucat/stop", "msg": {}}))
        with pytest.raises(ConnectionClosed):
            await socket.recv()


async def test_a_page_of_another_origin_gets_nothing_by_a_browsers_cookie(served: Served) -> None:
    cookie = {"Cookie": f"mucat_{served.settings.server.port}=anything"}
    async with open_rosbridge(served, None, origin="http://else.where", additional_headers=cookie) as socket:
        await socket.send(json.dumps({"op": "subscribe", "topic": "/depth"}))
        with pytest.raises(ConnectionClosed):
            await socket.recv()


async def test_samples_come_in_the_axes_units_and_stamps_of_ros(served: Served) -> None:
    """Rolled 0.3 rad to the right, nose up 0.2, turned 0.5 to the right, at a known place."""

    token = await make_token(served, "read")
    roll, pitch, yaw = 0.3, 0.2, 0.5
    attitude = _quaternion(roll, pitch, yaw)
    async with open_rosbridge(served, token) as socket:
        client = RosbridgeClient(socket)
        for topic in ("/imu/data", "/depth", "/pressure", "/temperature", "/pose", "/tf", "/beacon/left"):
            await client.say(op="subscribe", topic=topic)
        await client.say(op="subscribe", topic="/truth/odometry", type="nav_msgs/Odometry")
        await client.call("/rosapi/get_time")
        now = served.container.clock.now()
        served.runtime.publish(
            rows_block("truth", 0, (now, truth((1.0, 2.0, 0.7), attitude))),
            rows_block("depth", 0, (now, Depth(time=0, depth=0.7, pressure=108_000, temperature=18.5))),
            rows_block("beacon", 0, (now, Beacon(time=0, right=0, left=1))),
        )
        odometry = (await client.next("publish", topic="/truth/odometry"))["msg"]
        assert odometry["header"]["frame_id"] == "odom"
        assert odometry["child_frame_id"] == "base_link"
        position = odometry["pose"]["pose"]["position"]
        assert [round(position[axis], 6) for axis in "xyz"] == [1.0, -2.0, -0.7]
        served.runtime.publish(
            rows_block("imu", 0, (now, imu(attitude, rate=(0.1, 0.2, 0.3), force=(1.0, 2.0, -9.5))))
        )
        results: dict[str, Any] = {}
        while len(results) < 3:
            message = await client.next("publish")
            if message["topic"] in ("/imu/data", "/pose", "/tf"):
                results[message["topic"]] = message["msg"]
        measured = results["/imu/data"]
        assert _angles(measured["orientation"]) == pytest.approx((roll, -pitch, -yaw), abs=2e-4)
        assert _vector(measured["angular_velocity"]) == pytest.approx((0.1, -0.2, -0.3), abs=2e-4)
        assert _vector(measured["linear_acceleration"]) == pytest.approx((1.0, -2.0, 9.5), abs=1e-3)
        stamp = measured["header"]["stamp"]
        clock = served.container.clock
        before, utc_ns, after = clock.now(), served.get(Doors).utc_ns(), clock.now()
        age = (utc_ns - (stamp["sec"] * 10**9 + stamp["nanosec"])) / 1e9
        assert before - now - 0.01 < age < after - now + 0.01
        assert _angles(results["/pose"]["pose"]["orientation"])[2] == pytest.approx(-yaw, abs=2e-4)
        (transform,) = results["/tf"]["transforms"]
        assert _vector(transform["transform"]["translation"]) == pytest.approx((1.0, -2.0, -0.7))


async def test_pressure_temperature_and_beacons_have_their_standard_types(served: Served) -> None:
    token = await make_token(served, "read")
    async with open_rosbridge(served, token) as socket:
        client = RosbridgeClient(socket)
        for topic in ("/depth", "/pressure", "/temperature", "/beacon/left"):
            await client.say(op="subscribe", topic=topic)
        types = (await client.call("/rosapi/topic_type", {"topic": "/pressure"}))["values"]
        assert types == {"type": "sensor_msgs/msg/FluidPressure"}
        now = served.container.clock.now()
        served.runtime.publish(
            rows_block("depth", 0, (now, Depth(time=0, depth=0.7, pressure=108_000, temperature=18.5))),
            rows_block("beacon", 0, (now, Beacon(time=0, right=0, left=1))),
        )
        results: dict[str, Any] = {}
        while len(results) < 4:
            message = await client.next("publish")
            results[message["topic"]] = message["msg"]
        assert results["/depth"] == {"data": pytest.approx(0.7)}
        assert results["/pressure"]["fluid_pressure"] == 108_000
        assert results["/temperature"]["temperature"] == pytest.approx(18.5)
        assert results["/beacon/left"] == {"data": True}


async def test_throttle_and_queue_length_hold_samples_back(served: Served) -> None:
    token = await make_token(served, "read")
    async with open_rosbridge(served, token) as socket:
        client = RosbridgeClient(socket)
        await client.say(op="subscribe", topic="/depth", throttle_rate=600_000)
        await client.say(op="subscribe", topic="/mucat/depth", throttle_rate=1, queue_length=3)
        await client.call("/rosapi/get_time")
        rows = [
            (1.0 + position, Depth(time=0, depth=position / 10, pressure=101_325, temperature=20))
            for position in range(10)
        ]
        served.runtime.publish(rows_block("depth", 0, *rows))
        first = await client.next("publish", topic="/depth")
        assert first["msg"] == {"data": pytest.approx(0.9)}
        depths = [
            round((await client.next("publish", topic="/mucat/depth"))["msg"]["depth"], 3) for _ in range(3)
        ]
        assert depths == [0.7, 0.8, 0.9]
        served.runtime.publish(rows_block("depth", 10, *((time + 10, row) for time, row in rows)))
        for _ in range(3):
            assert (await client.next("publish"))["topic"] == "/mucat/depth"
        await client.call("/rosapi/get_time")
        await client.say(op="unsubscribe", topic="/depth")
        await client.say(op="unsubscribe", topic="/mucat/depth")
        await client.call("/rosapi/get_time")
        (rosbridge, *_) = (await served.api.get("/doors")).json()
        assert rosbridge["clients"][0]["topics"] == []


async def test_cbor_comes_where_it_is_asked_for_and_anything_else_as_plain_text(served: Served) -> None:
    token = await make_token(served, "read")
    async with open_rosbridge(served, token) as in_cbor, open_rosbridge(served, token) as in_text:
        for socket, asked in (
            (in_cbor, {"compression": "cbor"}),
            (in_text, {"compression": "png", "fragment_size": 4096}),
        ):
            client = RosbridgeClient(socket)
            await client.say(op="subscribe", topic="/camera/image/compressed", **asked)
            await client.call("/rosapi/get_time")
        await served.heard("picture")
        served.runtime.publish(picture_block(7, 9000))
        jpeg = bytes([7]) * 9000
        data = await in_cbor.recv()
        assert isinstance(data, bytes)
        assert jpeg in data
        plain = await RosbridgeClient(in_text).next("publish")
        assert base64.b64decode(plain["msg"]["data"]) == jpeg
        await RosbridgeClient(in_text).say(op="subscribe", topic="/depth", compression="cbor-raw")
        assert "cbor-raw" in (await RosbridgeClient(in_text).next("status"))["msg"]


async def test_a_program_drives_with_control_and_not_without(served: Served) -> None:
    await served.api.post("/control/release")
    token, reader = await make_token(served), await make_token(served, "read", "Reader")
    twist = {"linear": {"x": 0.5, "y": 0.25, "z": -3.0}, "angular": {"x": 0.1, "y": 0.2, "z": 0.3}}
    async with open_rosbridge(served, token) as socket, open_rosbridge(served, reader) as looking:
        client, viewer = RosbridgeClient(socket), RosbridgeClient(looking)
        await client.say(op="advertise", topic="/cmd_vel", type="geometry_msgs/Twist")
        await client.say(op="publish", topic="/cmd_vel", msg=twist)
        assert "Take control" in (await client.next("status"))["msg"]
        await viewer.say(op="publish", topic="/cmd_vel", msg=twist)
        assert "role of an operator" in (await viewer.next("status"))["msg"]
        refused = await viewer.call("/mucat/take_control")
        assert (refused["result"], "operator" in refused["values"]) == (False, True)
        assert (await client.call("/mucat/arm", {"mode": "manual"}))["result"] is False
        taken = await client.call("/mucat/take_control")
        assert taken["values"]["success"] is True
        assert (await client.call("/mucat/arm", {"mode": "manual"}))["result"] is True
        assert served.runtime.asked[-1] == ("arm", {"mode": "manual"})
        await client.say(op="publish", topic="/cmd_vel", msg=twist)
        await until(lambda: served.runtime.driven, "the command")
        assert served.runtime.driven[0]["axes"] == [0.5, -0.25, 1.0, 0.1, -0.2, -0.3]
        await client.say(op="publish", topic="/cmd_vel", msg={"linear": {"x": "fast"}})
        assert "numbers" in (await client.next("status"))["msg"]
        await viewer.say(op="publish", topic="/mucat/stop", msg={})
        await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")
        assert (await client.call("/mucat/release_control"))["result"] is True
        assert served.get(ControlArbiter).lease.holder is None
    expected = {
        ("Program", "Take control", "done"),
        ("Program", "arm", "done"),
        ("Program", "arm", "refused"),
        ("Program", "Drive", "done"),
        ("Program", "Message drive", "refused"),
        ("Reader", "Take control", "refused"),
        ("Reader", "STOP", "done"),
    }
    # What the runtime has answered is written a moment later.
    async with asyncio.timeout(SECONDS):
        while missing := expected - await acts_of(served):
            await asyncio.sleep(0.01)
    assert not missing


UNUSABLE_NUMBERS = ("NaN", "-Infinity", "1e400", "null", '"0.5"', "true", "[0.5]", "{}", "9007199254740993")


async def test_what_is_no_usable_number_drives_nothing_and_is_answered_in_words(served: Served) -> None:
    await served.api.post("/control/release")
    async with open_rosbridge(served, await make_token(served)) as socket:
        client = RosbridgeClient(socket)
        await client.call("/mucat/take_control")
        for number in UNUSABLE_NUMBERS:
            await socket.send(
                f'{{"op": "publish", "topic": "/cmd_vel", "msg": {{"linear": {{"x": {number}}}}}}}'
            )
            assert (await client.next("status"))["msg"].endswith("."), number
        await client.say(op="publish", topic="/cmd_vel", msg={})
        await until(lambda: served.runtime.driven, "the neutral command")
        assert [command["axes"] for command in served.runtime.driven] == [[0.0] * 6]


@pytest.mark.parametrize(
    "message",
    [
        {"op": "publish", "topic": "/mucat/stop", "msg": {}},
        {"op": "call_service", "service": "/mucat/stop", "id": "1"},
    ],
    ids=["message", "service"],
)
async def test_stop_goes_on_where_its_program_leaves_at_once(
    message: dict[str, Any], monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    # The answer comes late, but not too late, however busy the computer is.
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", SECONDS)
    answered = served.runtime.gates["stop"]
    answered.clear()
    async with open_rosbridge(served, await make_token(served)) as socket:
        await RosbridgeClient(socket).say(**message)
    await until(lambda: ("stop", {}) in served.runtime.asked, "STOP")
    async with asyncio.timeout(SECONDS):
        while any(door["clients"] for door in (await served.api.get("/doors")).json()):
            await asyncio.sleep(0.01)
    answered.set()
    async with asyncio.timeout(SECONDS):
        while ("Program", "STOP", "done") not in await acts_of(served):
            await asyncio.sleep(0.01)


@pytest.mark.parametrize(
    ("service", "fields", "command"),
    [
        ("/mucat/arm", {"mode": "manual"}, "arm"),
        ("/rosapi/set_param", {"name": "/depth.kp", "value": "2.5"}, "parameters"),
    ],
)
async def test_a_command_leaves_its_trace_where_its_program_leaves_before_the_answer(
    service: str, fields: dict[str, Any], command: str, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    # The answer comes late, but not too late, however busy the computer is.
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", SECONDS)
    await served.api.post("/control/release")
    served.runtime.answer = {"changed": {"depth.kp": [2.0, 2.5]}}
    answered = served.runtime.gates[command]
    answered.clear()
    async with open_rosbridge(served, await make_token(served)) as socket:
        client = RosbridgeClient(socket)
        assert (await client.call("/mucat/take_control"))["result"] is True
        await client.say(op="call_service", service=service, args=fields)
        await until(lambda: command in [name for name, _ in served.runtime.asked], "the command")
    async with asyncio.timeout(SECONDS):
        while any(door["clients"] for door in (await served.api.get("/doors")).json()):
            await asyncio.sleep(0.01)
    answered.set()
    async with asyncio.timeout(SECONDS):
        while ("Program", command, "done") not in await acts_of(served):
            await asyncio.sleep(0.01)
    (change,) = (await served.api.get("/parameters/changes")).json()
    assert (change["who"], change["values"][0]["name"]) == ("Program", "depth.kp")


async def test_control_ends_with_the_connection(served: Served) -> None:
    await served.api.post("/control/release")
    async with open_rosbridge(served, await make_token(served)) as socket:
        assert (await RosbridgeClient(socket).call("/mucat/take_control"))["result"] is True
        assert served.get(ControlArbiter).lease.holder is not None
    await until(lambda: served.get(ControlArbiter).lease.holder is None, "control to be free")


async def test_a_revoked_token_ends_its_connection(served: Served) -> None:
    async with open_rosbridge(served, await make_token(served)) as socket:
        await RosbridgeClient(socket).call("/rosapi/get_time")
        devices = (await served.api.get("/access/devices")).json()
        (device,) = (device["id"] for device in devices if device["name"] == "Program")
        (await served.api.delete(f"/access/devices/{device}")).raise_for_status()
        with pytest.raises(ConnectionClosed) as closed:
            await RosbridgeClient(socket).next("never")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1008


async def test_parameters_are_read_and_set(served: Served) -> None:
    async with open_rosbridge(served, await make_token(served)) as socket:
        client = RosbridgeClient(socket)
        assert (await client.call("/rosapi/get_param", {"name": "/depth.kp"}))["result"] is False
        await served.api.post("/control/release")
        await client.call("/mucat/take_control")
        answer = await client.call("/rosapi/set_param", {"name": "/depth.kp", "value": "2.5"})
        assert answer["result"] is True
        assert served.runtime.asked[-1] == ("parameters", {"values": {"depth.kp": 2.5}})
        listed = [{"name": "depth.kp", "type": "number", "value": 1.0}]
        document = json.dumps([{"time": 1.0, "parameters": listed}]).encode()
        served.runtime.publish(Block.of(BY_NAME["parameters"], 1, 0, document))
        await until(lambda: served.get(Doors).parameters(), "the parameters")
        assert (await client.call("/rosapi/get_param", {"name": "/depth.kp"}))["values"]["value"] == "1.0"
        served.runtime.answer = {"changed": {"depth.kp": [1.0, 2.5]}}
        await client.call("/rosapi/set_param", {"name": "/depth.kp", "value": "2.5"})
        assert (await client.call("/rosapi/get_param", {"name": "/depth.kp"}))["values"]["value"] == "2.5"
        wrong = await client.call("/rosapi/set_param", {"name": "/depth.kp", "value": "{"})
        assert wrong["result"] is False
        assert wrong["values"].startswith("value must be JSON: it is not JSON: Expecting property name")
        deleted = await client.call("/rosapi/delete_param", {"name": "/depth.kp"})
        assert (deleted["result"], "cannot be deleted" in deleted["values"]) == (False, True)


async def test_the_newest_state_comes_at_once_and_lines_of_text_are_the_log(served: Served) -> None:
    served.runtime.publish(state_block(0, mode="manual"))
    await until(lambda: served.get(Doors).document("state"), "the state")
    async with open_rosbridge(served, await make_token(served, "read")) as socket:
        client = RosbridgeClient(socket)
        await client.say(op="subscribe", topic="/mucat/state")
        assert (await client.next("publish"))["msg"]["mode"] == "manual"
        await client.say(op="subscribe", topic="/rosout", type="rcl_interfaces/msg/Log")
        await client.call("/rosapi/get_time")
        served.runtime.publish(debug_block(0, "hello"))
        line = await client.next("publish", topic="/rosout")
        while line["msg"]["file"] != "debug":
            line = await client.next("publish", topic="/rosout")
        assert (line["msg"]["msg"], line["msg"]["level"]) == ("hello", 20)


async def test_everything_that_is_listed_can_be_subscribed(served: Served) -> None:
    async with open_rosbridge(served, await make_token(served, "read")) as socket:
        client = RosbridgeClient(socket)
        listed = (await client.call("/rosapi/topics"))["values"]
        assert len(listed["topics"]) == len(listed["types"])
        for name, kind in zip(listed["topics"], listed["types"], strict=True):
            if name not in ("/cmd_vel", "/mucat/stop"):
                await client.say(op="subscribe", topic=name, type=kind)
        await client.call("/rosapi/nodes")
        (rosbridge, *_) = (await served.api.get("/doors")).json()
        assert set(rosbridge["clients"][0]["topics"]) == set(listed["topics"]) - {
            "/cmd_vel",
            "/mucat/stop",
        }


INVALID = (
    *("", "{", "[]", "7", '"x"', '{"op": 7}', '{"op": "fly"}', '{"op": "subscribe"}'),
    '{"op": "advertise_service", "service": "/mine", "type": "a/B"}',
    '{"op": "subscribe", "topic": "/no"}',
    '{"op": "subscribe", "topic": "/depth", "type": "a/B"}',
    '{"op": "subscribe", "topic": "/depth", "throttle_rate": -1}',
    '{"op": "subscribe", "topic": "/depth", "queue_length": 1e999}',
    '{"op": "fragment", "data": "x"}',
    '{"op": "publish", "topic": "/depth"}',
    '{"op": "publish", "topic": "/cmd_vel"}',
    '{"op": "set_level", "level": "all"}',
    '{"op": "call_service", "service": 7}',
    "[" * 2000,
)


async def test_an_invalid_operation_is_answered_in_words(served: Served) -> None:
    token = await make_token(served)
    async with open_rosbridge(served, token) as socket:
        client = RosbridgeClient(socket)
        for message in INVALID:
            await socket.send(message)
            assert (await client.next("status"))["msg"].endswith((".", "?")), message
            assert (await client.call("/rosapi/get_time"))["result"] is True
        for _ in range(INVALID_MAX):
            await socket.send("{")
        with pytest.raises(ConnectionClosed):
            await client.next("never")


TRIFLES: tuple[dict[str, Any], ...] = ({"args": [{}]}, {"args": 7}, {"id": "x" * 201})


@pytest.mark.parametrize("trifle", TRIFLES, ids=lambda item: next(iter(item)))
async def test_an_invalid_call_is_answered_with_the_reason_and_stop_is_carried_out_nevertheless(
    trifle: dict[str, Any], served: Served
) -> None:
    async with open_rosbridge(served, await make_token(served)) as socket:
        client = RosbridgeClient(socket)
        called = {"op": "call_service", "id": "1", **trifle}
        await client.say(op="set_level", level="none")
        await client.say(service="/rosapi/nodes", **called)
        refused = await client.next("service_response", id=called["id"])
        assert (refused["result"], refused["values"].endswith(".")) == (False, True)
        await client.say(service="/mucat/stop", **called)
        assert (await client.next("service_response", id=called["id"]))["result"] is True
        assert served.runtime.asked[-1] == ("stop", {})


async def test_a_program_that_reads_nothing_is_disconnected_and_harms_nobody(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    hurry(monkeypatch, "Stalled")

    async with serve(settings) as served:
        token, other = await make_token(served, "read"), await make_token(served, "read", "Stalled")
        async with (
            open_rosbridge(served, other, max_queue=1) as stalled,
            open_rosbridge(served, token) as well,
        ):
            stalled.transport.pause_reading()
            for socket in (stalled, well):
                await RosbridgeClient(socket).say(op="subscribe", topic="/camera/image/compressed")
            await RosbridgeClient(well).call("/rosapi/get_time")
            await served.heard("picture")
            door = served.get(Doors).doors["rosbridge"]
            await until(lambda: len(door.clients) == 2, "both")
            number = 0
            while len(door.clients) == 2:
                number += 1
                served.get(Doors).see(picture_block(number, 300_000))
                picture = await RosbridgeClient(well).next("publish")
                assert picture["topic"] == "/camera/image/compressed"
                await asyncio.sleep(0)
            assert [client.identity.name for client in door.clients] == ["Program"]
            # It would wait for the server's goodbye, which it does not read either.
            stalled.transport.abort()


def _quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Body to world, turned by yaw, then pitch, then roll."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(angle / 2), sin(angle / 2)) for angle in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _angles(turn: dict[str, float]) -> tuple[float, float, float]:
    w, x, y, z = (turn[axis] for axis in "wxyz")
    return (
        atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        asin(2 * (w * y - z * x)),
        atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
    )


def _vector(values: dict[str, float]) -> tuple[float, float, float]:
    return values["x"], values["y"], values["z"]
