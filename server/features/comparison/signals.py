"""Signals of a session over time: each column of its rows, and numbers of some documents."""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from server.features.sessions.chunks import row_layout
from server.features.sessions.recording import Recording, depth_loop


class Signal(BaseModel):
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
    "state": {
        "set_point": DocumentColumn(
            "m", "set point of the depth", lambda one: float(depth_loop(one)["set_point"])
        ),
        "set_point_default": DocumentColumn(
            "m", "set point of the depth by default", _number("set_point_default")
        ),
        "set_point_detected": DocumentColumn(
            "m", "set point of the depth while the colour is seen", _number("set_point_detected")
        ),
        "armed": DocumentColumn("", "1 while the robot is armed", _number("armed")),
    },
    "detection": {
        "area": DocumentColumn("", "share of the picture that has the colour", _number("area")),
        "seen": DocumentColumn(
            "", "1 if a colour was found in the picture", lambda one: float(one["colour"] is not None)
        ),
        "processing": DocumentColumn("s", "processing time of the picture", _number("processing")),
    },
}


def list_signals(recording: Recording, topics: Container[str] | None = None) -> list[Signal]:
    """The signals of these topics, or of all, that have samples. Raises StoreError."""
    found: list[Signal] = []
    for topic, described in recording.topics.items():
        if (topics is not None and topic not in topics) or not recording.has(topic):
            continue
        if described["kind"] == "rows":
            found += _row_signals(topic, described)
        else:
            known = DOCUMENT_COLUMNS.get(topic, {})
            found += [_signal(topic, name, one.unit, one.meaning) for name, one in known.items()]
    return found


def split(name: str) -> tuple[str, str]:
    """The topic and column in a signal's name. Raises ValueError for an invalid name."""
    topic, dot, column = name.partition(".")
    if not (topic and dot and column):
        raise ValueError(f"“{name}” is not a signal's name; one looks like depth.depth")
    return topic, column


def _row_signals(topic: str, described: dict[str, Any]) -> list[Signal]:
    fields = [field for field in described["fields"] for _ in range(field["count"])]
    return [
        _signal(topic, column, field["unit"], field["meaning"])
        for column, field in zip(row_layout(described).names, fields, strict=True)
    ]


def _signal(topic: str, column: str, unit: str, meaning: str) -> Signal:
    return Signal(name=f"{topic}.{column}", topic=topic, column=column, unit=unit, meaning=meaning)
