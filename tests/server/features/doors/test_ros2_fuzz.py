"""Anything at all as a message or call of a ROS 2 program: it is used, or refused and counted."""

from collections.abc import Coroutine
from contextlib import suppress
from struct import pack
from typing import Any
from unittest.mock import MagicMock

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from server.container import Container
from server.features.doors.commands import DoorCommands
from server.features.doors.house import Doors
from server.features.doors.ros2_messages import TRIGGER, ros2_types
from server.features.doors.ros2_names import Attachment
from server.features.doors.ros2_node import Incoming
from server.features.doors.ros2_session import Ros2Session, ros2_endpoints
from server.features.doors.ros_channels import standard_channels
from server.features.doors.session import UnusableMessageError
from tests.server.features.doors.fuzz_rig import CHECKS, join_door

EXAMPLES = 200
NUMBERS = st.lists(st.floats() | st.floats(-2, 2), min_size=6, max_size=6)
PAYLOADS = (
    st.none()
    | st.binary(max_size=70)
    | st.builds(lambda head, rest: head + rest, st.sampled_from([b"\0\1\0\0", b"\0\0\0\0"]), st.binary())
    | NUMBERS.map(lambda six: b"\0\1\0\0" + pack("<6d", *six))
)


@settings(max_examples=EXAMPLES, suppress_health_check=CHECKS)
@given(position=st.integers(0), typed=st.booleans(), payload=PAYLOADS, attachment=st.binary(max_size=40))
async def test_the_door_uses_or_refuses_anything(
    container: Container, position: int, typed: bool, payload: bytes | None, attachment: bytes
) -> None:
    """Nobody has control, so that driving is refused, too."""
    endpoints = [endpoint for endpoint in ros2_endpoints(standard_channels()) if endpoint.kind != "MP"]
    endpoint = endpoints[position % len(endpoints)]
    query: Any = object() if endpoint.kind == "SS" else None

    async def writable() -> None:
        pass

    with join_door(container, "ros2") as (client, pilot, commands):
        session = Ros2Session(client, pilot, container.services.get(Doors), commands, writable)
        calls: list[Coroutine[Any, Any, None]] = []
        session.begin = lambda call, **_: calls.append(call)  # type: ignore[method-assign]
        session.act(Incoming(endpoint, typed, payload, attachment, query), None)  # type: ignore[arg-type]
        assert client.refused == (not calls)
        for call in calls:
            call.close()


async def test_the_bytes_of_a_twist_drive_only_with_its_type(monkeypatch: pytest.MonkeyPatch) -> None:
    driven: list[list[float]] = []
    monkeypatch.setattr(DoorCommands, "__init__", lambda _: None)
    monkeypatch.setattr(DoorCommands, "note_refusal", lambda *_: None)
    monkeypatch.setattr(DoorCommands, "drive", lambda _, __, linear, ___: driven.append(linear))
    (twist,) = (endpoint for endpoint in ros2_endpoints(standard_channels()) if endpoint.name == "/cmd_vel")
    payload = b"\0\1\0\0" + pack("<6d", 1, 2, 3, 4, 5, 6)

    doors, client = MagicMock(), MagicMock(refused=0)
    session = Ros2Session(client, MagicMock(), doors, DoorCommands(), MagicMock())  # type: ignore[call-arg]
    for typed in (False, True):
        session.act(Incoming(twist, typed, payload, b""), MagicMock())
    assert (client.refused, driven) == (1, [[1, 2, 3]])


@settings(max_examples=1000)
@given(kind=st.sampled_from(["geometry_msgs/msg/Twist", f"{TRIGGER}_Request"]), data=st.binary(max_size=80))
def test_any_bytes_are_a_message_or_none(kind: str, data: bytes) -> None:
    for head in (b"", b"\0\1\0\0", b"\0\0\0\0"):
        with suppress(ValueError):
            ros2_types().decode(kind, head + data)


@given(data=st.binary(max_size=40) | st.binary(min_size=33, max_size=33))
def test_any_bytes_are_an_attachment_or_none(data: bytes) -> None:
    try:
        result = Attachment.from_bytes(data)
    except UnusableMessageError:
        assert len(data) != 33 or data[16] != 16
    else:
        assert result.to_bytes() == data
