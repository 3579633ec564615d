"""Numbers and names of declared things are unique."""

import re
from collections.abc import Callable

import pytest

from robot_runtime.contract.commands import RobotCommand, command
from robot_runtime.contract.declarations import Declarations, DeclaredTwiceError
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets.definitions import Packet, _packet
from robot_runtime.contract.topics import BY_ID, BY_NAME, DEPTH, Kind, topic
from robot_runtime.missions.leaf import MissionNode, mission_node
from robot_runtime.missions.leaves.doing import MarkLeaf
from server.http.sign_in.policy import Need

HERE = re.escape(__file__)


@pytest.mark.parametrize(
    ("declare", "key", "first"),
    [
        (lambda: topic(DEPTH.id, "another", Kind.DOCUMENTS, Event, "another"), DEPTH.id, "topics.py"),
        (lambda: topic(250, "depth", Kind.DOCUMENTS, Event, "another"), "depth", "topics.py"),
        (lambda: _packet(0)(type("Another", (Packet,), {})), 0, "definitions.py"),
        (lambda: command("arm", Need.CONTROL)(type("Another", (RobotCommand,), {})), "arm", "commands.py"),
        (lambda: mission_node("mark")(type("Another", (MissionNode,), {})), MarkLeaf.do, "doing.py"),
    ],
)
def test_a_second_use_is_refused_with_both_places(
    declare: Callable[[], object], key: object, first: str
) -> None:
    with pytest.raises(DeclaredTwiceError, match=rf"{key!r} is declared twice: .*{first}:\d+ and at {HERE}:"):
        declare()


def test_a_topic_is_found_by_number_and_name() -> None:
    assert BY_ID[DEPTH.id] is BY_NAME["depth"] is DEPTH


def test_they_are_listed_in_the_order_of_declaration() -> None:
    declared: Declarations[str, int] = Declarations("a name")
    declared.add("b", 1)
    declared.add("a", 2)
    assert [*declared.items()] == [("b", 1), ("a", 2)]
