"""Anything at all as a program's message: it is used, or refused in words, and nothing else happens."""

import asyncio
import json
from contextlib import suppress
from struct import pack

from hypothesis import given, settings
from hypothesis import strategies as st

from server.container import Container
from server.features.doors.foxglove import FoxgloveSession
from server.features.doors.house import Doors
from server.features.doors.rosbridge import REFUSED_OPS, RosbridgeSession
from server.features.doors.session import UnusableMessageError
from tests.server.features.doors.fuzz_rig import CHECKS, join_door

EXAMPLES = 150
NAMES = ["/depth", "/cmd_vel", "/mucat/stop", "/rosapi/topics", "/mucat/arm", "rosapi/get_param", "/tf", ""]
PLAIN = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20) | st.sampled_from(NAMES)
)
JSON = st.recursive(
    PLAIN,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=9), inner, max_size=4),
    max_leaves=8,
)
ROSBRIDGE_OPS = [
    "subscribe",
    "unsubscribe",
    "advertise",
    "unadvertise",
    "publish",
    "call_service",
    "set_level",
]
ROSBRIDGE_KEYS = ["topic", "type", "id", "msg", "service", "args", "throttle_rate", "queue_length"]
ROSBRIDGE_KEYS += ["compression", "level"]
FOXGLOVE_OPS = ["subscribe", "unsubscribe", "advertise", "unadvertise", "getParameters", "setParameters"]
FOXGLOVE_OPS += ["subscribeParameterUpdates", "unsubscribeParameterUpdates"]
FOXGLOVE_KEYS = ["subscriptions", "subscriptionIds", "channels", "channelIds", "parameterNames", "parameters"]
FOXGLOVE_KEYS += ["id"]
CHANNEL = st.fixed_dictionaries(
    {}, optional=dict.fromkeys(("id", "channelId", "topic", "encoding", "schemaName", "name", "value"), JSON)
)


def operations(ops: list[str], keys: list[str]) -> st.SearchStrategy[str]:
    values = dict.fromkeys(keys, JSON | st.lists(CHANNEL, max_size=3))
    answer = st.fixed_dictionaries({"op": st.sampled_from(ops) | PLAIN}, optional=values)
    return answer.map(json.dumps)


BINARY = st.binary(max_size=40) | st.builds(
    lambda op, numbers, data: bytes([op]) + pack("<III", *numbers) + data,
    st.integers(0, 3),
    st.tuples(*[st.integers(0, 40) | st.integers(0, 2**32 - 1)] * 3),
    st.binary(max_size=30),
)


def act(
    container: Container, door: str, kind: type[RosbridgeSession | FoxgloveSession], message: str | bytes
) -> None:
    async def run() -> None:
        opened = container.services.get(Doors).doors[door]
        with join_door(container, door) as (client, pilot, commands):
            session = kind(client, pilot, container.services.get(Doors), opened, commands)
            with suppress(UnusableMessageError):
                session.act(message)
            session.cancel_calls()
            for subscription in client.subscriptions.values():
                opened.publisher.unsubscribe(subscription)

    asyncio.run(run())


@settings(max_examples=EXAMPLES, suppress_health_check=CHECKS)
@given(message=operations([*ROSBRIDGE_OPS, *REFUSED_OPS], ROSBRIDGE_KEYS) | st.text() | st.binary())
def test_the_rosbridge_door_uses_or_refuses_anything(container: Container, message: str | bytes) -> None:
    act(container, "rosbridge", RosbridgeSession, message)


@settings(max_examples=EXAMPLES, suppress_health_check=CHECKS)
@given(message=operations(FOXGLOVE_OPS, FOXGLOVE_KEYS) | st.text() | BINARY)
def test_the_foxglove_door_uses_or_refuses_anything(container: Container, message: str | bytes) -> None:
    act(container, "foxglove", FoxgloveSession, message)
