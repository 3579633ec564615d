"""The table of operations in the reference names every operation of both protocols, and tells the truth."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from server.features.doors.foxglove import CAPABILITIES
from server.features.doors.rosapi import ARGUMENTS, REFUSED
from server.features.doors.rosbridge import REFUSED_OPS
from server.platform.settings import Settings
from tests.server.features.doors.rig import OPEN, RosbridgeClient, make_token, open_rosbridge
from tests.server.features.doors.test_foxglove import next_op, open_foxglove
from tests.server.serving import Served, serve

ROOT = Path(__file__).parents[4]
PAGE = (ROOT / "docs/reference/doors.md").read_text(encoding="utf-8")
PROTOCOL = ROOT / "tests/clients/node_modules/@foxglove/ws-protocol/dist/esm/src/types.d.ts"
ROSBRIDGE_PROTOCOL = (
    *("advertise", "unadvertise", "publish", "subscribe", "unsubscribe", "call_service", "advertise_service"),
    *("unadvertise_service", "service_response", "fragment", "png", "set_level", "status", "auth"),
    *("advertise_action", "unadvertise_action", "send_action_goal", "cancel_action_goal"),
    *("action_feedback", "action_result"),
)
"""Every op of rosbridge's protocol, version 2."""


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return settings.with_section(OPEN)


def section(title: str) -> str:
    """Return a section of the page."""
    return PAGE.split(f"## {title}\n")[1].split("\n## ")[0]


@pytest.mark.parametrize("op", ROSBRIDGE_PROTOCOL)
def test_the_page_names_every_operation_of_rosbridge(op: str) -> None:
    assert f"`{op}`" in section("rosbridge: operations")


def test_the_page_names_every_operation_of_foxglove() -> None:
    ops = set(re.findall(r'op: "(\w+)"', PROTOCOL.read_text(encoding="utf-8")))
    assert len(ops) >= 19
    assert {op for op in ops if f"`{op}`" not in section("Foxglove: operations")} == set()


@pytest.mark.parametrize("service", [*ARGUMENTS, *REFUSED])
def test_the_page_names_every_service_of_rosapi(service: str) -> None:
    assert re.search(rf"`(/rosapi/)?{service}`", section("rosbridge: operations"))


async def test_each_operation_that_the_page_calls_refused_is_refused_in_words(settings: Settings) -> None:
    rows = [row for row in section("rosbridge: operations").splitlines() if "refused in words |" in row]
    named = {op for row in rows for op in re.findall(r"`(\w+)`", row) if op in ROSBRIDGE_PROTOCOL}
    assert named >= set(REFUSED_OPS) - {"auth"}

    async with serve(settings) as served, open_rosbridge(served, await make_token(served)) as socket:
        client = RosbridgeClient(socket)
        for op in [*REFUSED_OPS]:
            await client.say(op=op)
            assert (await client.next("status"))["msg"] == REFUSED_OPS[op]
            # An operation in between, so that these are not taken for nonsense.
            await client.call("/rosapi/get_time")
        for service in REFUSED:
            answer = await client.call(f"/rosapi/{service}")
            assert (answer["result"], answer["values"]) == (False, REFUSED[service])
        for name, value in (("cbor-raw", "There is no compression"), ("zip", "There is no compression")):
            await client.say(op="subscribe", topic="/depth", compression=name)
            assert (await client.next("status"))["msg"].startswith(value)
        await client.say(op="fly")
        assert (await client.next("status"))["msg"].startswith("Unknown op")
        assert (await client.call("/rosapi/fly"))["values"].startswith("There is no service")


async def test_foxgloves_operations_do_what_the_page_says(served: Served) -> None:
    async with open_foxglove(served, await make_token(served)) as socket:
        assert tuple((await next_op(socket, "serverInfo"))["capabilities"]) == CAPABILITIES
        assert (await next_op(socket, "advertiseServices"))["services"]

        async def say(**message: Any) -> None:
            await socket.send(json.dumps(message))

        await say(op="getParameters", parameterNames=[], id="all")
        assert (await next_op(socket, "parameterValues"))["id"] == "all"
        # Without control the values in force come back.
        await say(op="setParameters", parameters=[{"name": "control.rate", "value": 5}], id="set")
        assert "were not set" in (await next_op(socket, "status"))["message"]
        assert (await next_op(socket, "parameterValues"))["id"] == "set"
        for op in ("subscribeConnectionGraph", "fetchAsset", "fly"):
            await say(op=op)
            assert (await next_op(socket, "status"))["message"].startswith("Unknown op")
