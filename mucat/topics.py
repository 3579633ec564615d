"""The topics of a robot as its server describes them, so that other versions than this one are understood."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from struct import Struct
from typing import Any

from mucat.address import RobotAddress
from mucat.errors import RobotError
from robot_runtime.contract.chunks import describe_topic, row_fields
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.contract.topics import TOPICS

NOT_FOUND = 404


@dataclass(frozen=True)
class TopicDescription:
    """A topic: its number in a block, and its description as `GET /api/topics` has it."""

    number: int
    name: str
    kind: str
    newest_only: bool
    described: Mapping[str, Any]

    @cached_property
    def _fields(self) -> list[tuple[str, int, float]]:
        return [(field.name, field.count, field.scale) for field in row_fields(self.described)]

    @cached_property
    def _row(self) -> Struct:
        codes = "".join(field.count * field.code for field in row_fields(self.described))
        return Struct(f"<d{codes}")

    def read_rows(self, payload: bytes) -> Iterator[tuple[float, dict[str, Any]]]:
        """Yield the time (s) and the fields, in SI units, of each row of a block."""
        for time, *counts in self._row.iter_unpack(payload):
            fields, at = {}, 0
            for name, count, scale in self._fields:
                values = [value if scale == 1 else value * scale for value in counts[at : at + count]]
                fields[name] = values[0] if count == 1 else tuple(values)
                at += count
            yield time, fields


@dataclass(frozen=True)
class RobotTopics:
    """The topics of a robot by name. `definitions`: the ones that they hold for, None for any robot's."""

    by_name: Mapping[str, TopicDescription]
    definitions: str | None = None

    def check(self, definitions: str, names: frozenset[str]) -> None:
        """Raise RobotError where topics of these names cannot be read of a robot with such definitions."""
        if self.definitions not in (None, definitions) and any(
            self.by_name[name].kind == "rows" for name in names
        ):
            raise RobotError(
                "The robot's software is older than 0.3 and does not describe its samples. Update the robot, "
                "or install its version of mucat here. State, events and pictures can be read all the same."
            )


def ask_topics(address: RobotAddress) -> RobotTopics:
    """Return the topics of the server at this address. Raise RobotError.

    One that does not describe them is taken to have this version's.
    """
    try:
        listed: list[dict[str, Any]] = address.ask("GET", "/topics")
    except RobotError as problem:
        if problem.status != NOT_FOUND:
            raise
        return RobotTopics(_describe(_own_topics()), f"{DEFINITIONS_HASH:08x}")
    return RobotTopics(_describe(listed))


def _own_topics() -> list[dict[str, Any]]:
    return [
        {"id": topic.id, "name": topic.name, "newest_only": topic.newest_only, **describe_topic(topic)}
        for topic in TOPICS
        if not topic.only_recorded
    ]


def _describe(listed: list[dict[str, Any]]) -> dict[str, TopicDescription]:
    return {
        topic["name"]: TopicDescription(
            topic["id"], topic["name"], topic["kind"], topic.get("newest_only", False), topic
        )
        for topic in listed
    }
