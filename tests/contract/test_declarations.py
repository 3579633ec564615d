"""Numbers and names of declared things are unique."""

import re
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from robot_runtime.contract.commands import RobotCommand, command
from robot_runtime.contract.declarations import Declarations, DeclaredTwiceError
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets.definitions import Packet, _packet
from robot_runtime.contract.topics import BY_ID, BY_NAME, DEPTH, Topic
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.experiments.scenario.events import EVENTS
from robot_runtime.missions.leaf import MissionNode, mission_node
from robot_runtime.missions.leaves.doing import MarkLeaf
from server.feature import Feature, list_features
from server.health.faults import SERVER_FAULTS
from server.http.sign_in.policy import Need

HERE = re.escape(__file__)


def declare_again(things: Declarations[str, Any], name: str) -> None:
    """Declare a thing of the same name."""
    things[name] = things[name]


@pytest.mark.parametrize(
    ("declare", "key", "first"),
    [
        (lambda: Topic(DEPTH.id, "another", Event, "another"), DEPTH.id, "topics.py"),
        (lambda: Topic(250, "depth", Event, "another"), "depth", "topics.py"),
        (lambda: _packet(0)(type("Another", (Packet,), {})), 0, "definitions.py"),
        (lambda: command("arm", Need.CONTROL)(type("Another", (RobotCommand,), {})), "arm", "commands.py"),
        (lambda: declare_again(EVENTS, "waves"), "waves", "scenario/events.py"),
        (lambda: declare_again(ROBOT_FAULTS, "capsized"), "capsized", "control/faults.py"),
        (lambda: declare_again(SERVER_FAULTS, "disk_low"), "disk_low", "health/faults.py"),
        (lambda: mission_node("mark")(type("Another", (MissionNode,), {})), MarkLeaf.do, "doing.py"),
    ],
)
def test_a_second_use_is_refused_with_both_places(
    declare: Callable[[], object], key: object, first: str
) -> None:
    with pytest.raises(DeclaredTwiceError, match=rf"{key!r} is declared twice: .*{first}:\d+ and at {HERE}:"):
        declare()


@pytest.mark.parametrize(
    ("feature", "key"),
    [(Feature(name="sessions"), "sessions"), (Feature(name="lamp", commands={"sessions": ""}), "sessions")],
)
def test_a_feature_of_a_name_or_command_that_is_taken_is_refused(
    feature: Feature, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    point = SimpleNamespace(value="lamp:FEATURE", load=lambda: feature)
    monkeypatch.setattr("server.feature.entry_points", lambda **_: [point])
    with pytest.raises(
        DeclaredTwiceError, match=rf"'{key}' is declared twice: at server\.features\.sessions and at lamp:"
    ):
        list_features.__wrapped__()


def test_a_topic_is_found_by_number_and_name() -> None:
    assert BY_ID[DEPTH.id] is BY_NAME["depth"] is DEPTH


def test_they_are_listed_in_the_order_of_declaration() -> None:
    declared: Declarations[str, int] = Declarations("a name")
    declared.add("b", 1)
    declared.add("a", 2)
    assert [*declared.items()] == [("b", 1), ("a", 2)]
