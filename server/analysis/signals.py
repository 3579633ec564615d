"""Signals of a session over time: each column of its rows, and numbers of some documents."""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from typing import Any

from robot_runtime.contract.chunks import row_fields
from robot_runtime.contract.topics import DETECTION, STATE
from server.library.content import Recording, depth_loop
from server.platform.schema_base import Schema


class Signal(Schema):
    """One number over time; `name` is topic and column, joined by a dot."""

    name: str
    topic: str
    column: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class DocumentColumn:
    """A number that a document holds."""

    unit: str
    meaning: str
    read: Callable[[Mapping[str, Any]], float]


def _number(key: str) -> Callable[[Mapping[str, Any]], float]:
    return lambda document: float(document[key])


DOCUMENT_COLUMNS: Mapping[str, Mapping[str, DocumentColumn]] = {
    STATE.name: {
        "set_point": DocumentColumn(
            "m", "set point of the depth", lambda state: float(depth_loop(state)["set_point"])
        ),
        "set_point_default": DocumentColumn(
            "m", "set point of the depth by default", _number("set_point_default")
        ),
        "set_point_detected": DocumentColumn(
            "m", "set point of the depth while the colour is seen", _number("set_point_detected")
        ),
        "armed": DocumentColumn("", "1 while the robot is armed", _number("armed")),
    },
    DETECTION.name: {
        "area": DocumentColumn("", "share of the picture that has the colour", _number("area")),
        "seen": DocumentColumn(
            "",
            "1 if a colour was found in the picture",
            lambda detection: float(detection["colour"] is not None),
        ),
        "processing": DocumentColumn("s", "processing time of the picture", _number("processing")),
    },
}


def list_signals(recording: Recording, topics: Container[str] | None = None) -> list[Signal]:
    """Return the signals of these topics, or of all, that have samples. Raise StoreError."""
    signals: list[Signal] = []
    for topic, described in recording.topics.items():
        if (topics is not None and topic not in topics) or not recording.has(topic):
            continue
        if described["kind"] == "rows":
            signals += _row_signals(topic, described)
        else:
            known = DOCUMENT_COLUMNS.get(topic, {})
            signals += [_signal(topic, name, column.unit, column.meaning) for name, column in known.items()]
    return signals


def split(name: str) -> tuple[str, str]:
    """Return the topic and column in a signal's name. Raise ValueError for an invalid name."""
    topic, dot, column = name.partition(".")
    if not (topic and dot and column):
        raise ValueError(f"“{name}” is not a signal's name; one looks like depth.depth")
    return topic, column


def _row_signals(topic: str, described: dict[str, Any]) -> list[Signal]:
    return [
        _signal(topic, column, field.unit, field.meaning)
        for field in row_fields(described)
        for column in field.columns
    ]


def _signal(topic: str, column: str, unit: str, meaning: str) -> Signal:
    return Signal(name=f"{topic}.{column}", topic=topic, column=column, unit=unit, meaning=meaning)
