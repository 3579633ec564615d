"""Robots of other versions: what they describe is read, what they lack is said in words."""

import json
from struct import Struct
from typing import Any

import pytest

from mucat import Robot, RobotError
from mucat.address import RobotAddress
from mucat.live import LiveReader
from mucat.topics import ask_topics
from robot_runtime.contract.packets import DEFINITIONS_HASH, Depth
from robot_runtime.contract.topics import BY_NAME, DEPTH, STATE, TIME
from robot_runtime.transport.blocks import HEADER, Block, row

LATER: list[dict[str, Any]] = [
    {
        "id": 2,
        "name": "depth",
        "meaning": "depth and salinity",
        "kind": "rows",
        "newest_only": False,
        "since": "0.4",
        "fields": [
            {"name": "salinity", "code": "B", "count": 2, "scale": 1.0, "unit": "", "meaning": ""},
            {"name": "depth", "code": "i", "count": 1, "scale": 0.5, "unit": "m", "meaning": "", "of": 3},
        ],
    },
    {"id": 77, "name": "sonar", "meaning": "echoes", "kind": "documents", "fields": [{"name": "time"}]},
    {"id": 78, "name": "smell", "meaning": "unknown", "kind": "scent", "fields": []},
]
"""Topics as a later version might describe them."""
DEPTH_ROW = Struct("<dBBi")


def address_that_answers(monkeypatch: pytest.MonkeyPatch, answer: object) -> RobotAddress:
    def ask(*_: object) -> object:
        if isinstance(answer, RobotError):
            raise answer
        return answer

    monkeypatch.setattr(RobotAddress, "ask", ask)
    return RobotAddress("http://turtle.local:8000", "mucat_token")


def block(number: int, kind: int, payload: bytes) -> bytes:
    return HEADER.pack(number, kind, 1, 0, len(payload)) + payload


def hello(definitions: int, steady: float = 10.0) -> str:
    return json.dumps({"op": "hello", "definitions": f"{definitions:08x}", "steady": steady, "new": 1})


def test_a_later_robot_s_samples_are_read_as_it_describes_them(monkeypatch: pytest.MonkeyPatch) -> None:
    topics = ask_topics(address_that_answers(monkeypatch, LATER))
    reader = LiveReader(("depth", "sonar"), topics)
    reader.greet(hello(DEFINITIONS_HASH ^ 1))
    message = block(78, 9, b"musty") + block(2, 0, DEPTH_ROW.pack(11.0, 3, 4, 5))
    message += block(2, 0, DEPTH_ROW.pack(9.0, 3, 4, 1)) + block(77, 1, b'[{"time": 12.0, "echoes": 2}]')
    depth, sonar = reader.read(message)
    assert (depth.topic, depth.time, depth.fields) == ("depth", 11.0, {"salinity": (3, 4), "depth": 2.5})
    assert (sonar.topic, sonar["echoes"]) == ("sonar", 2)


def test_an_earlier_robot_that_describes_nothing_is_read_where_it_is_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    topics = ask_topics(address_that_answers(monkeypatch, RobotError("Not Found", 404)))
    depth = Depth(time=7, depth=1.25, pressure=113_000, temperature=18.5)
    message = Block.of(DEPTH, 1, 0, row(11.0, depth.to_bytes())).data
    reader = LiveReader(("depth",), topics)
    reader.greet(hello(DEFINITIONS_HASH))
    (sample,) = reader.read(message)
    assert sample.fields == {name: getattr(depth, name) for name in Depth.wires}
    with pytest.raises(RobotError, match=r"is older than 0\.3"):
        LiveReader(("depth", "state"), topics).greet(hello(DEFINITIONS_HASH ^ 1))


def test_state_and_pictures_of_an_earlier_robot_are_read_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    topics = ask_topics(address_that_answers(monkeypatch, RobotError("Not Found", 404)))
    reader = LiveReader(("state", "picture"), topics)
    reader.greet(hello(DEFINITIONS_HASH ^ 1))
    assert reader.pictures == ["picture"]
    picture = BY_NAME["picture"]
    message = block(STATE.id, STATE.kind, b'[{"time": 1.0, "armed": false}]')
    message += block(picture.id, picture.kind, TIME.pack(12.0) + b"jpeg")
    state, seen = reader.read(message)
    assert (state["armed"], seen["jpeg"]) == (False, b"jpeg")


def test_another_refusal_than_a_missing_route_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(RobotError, match="not signed in"):
        ask_topics(address_that_answers(monkeypatch, RobotError("You are not signed in.", 401)))
    with pytest.raises(RobotError, match="There is no topic height; there are depth, sonar, smell"):
        LiveReader(("height",), ask_topics(address_that_answers(monkeypatch, LATER)))


def test_parameters_of_a_later_robot_have_what_it_says(monkeypatch: pytest.MonkeyPatch) -> None:
    address_that_answers(monkeypatch, {"time": 1, "parameters": [{"name": "fins.flex", "value": 2, "of": 3}]})
    assert Robot("http://turtle.local:8000", "mucat_token").parameters()["fins.flex"]["value"] == 2
