"""Differences between sessions: configuration, gains in force, versions, craft, scenario."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import Field

from robot_runtime.contract.toml_text import TomlError, read_toml
from server.analysis.moments import ControlHistory, ControlPeriod, Span
from server.library.crafts import describe_crafts
from server.platform.models import SessionRow
from server.platform.schema_base import Schema

_ROW: Mapping[str, str] = {
    "scenario_name": "Scenario",
    "seed": "Seed",
    "origin": "Started by",
    "robot": "Robot",
    "version": "Version of the software",
    "software": "Hash of the software",
    "firmware": "Hash of the firmware",
    "definitions": "Hash of the packets",
}
_STATE: Mapping[str, str] = {
    "set_point_default": "Set point, m",
    "set_point_detected": "Set point while the colour is seen, m",
    "control_rate": "Control rate, Hz",
    "vision_rate": "Vision rate, Hz",
    "steering": "Course",
    "vision_colour": "Colour looked for",
    "camera": "Camera",
    "baud": "Serial line, baud",
}
CHANGED = "changed while armed: "


class Difference(Schema):
    """A property that differs between sessions."""

    group: str = Field(description="In force, Parameters, Session, Craft, robot.toml or Scenario")
    name: str
    values: list[str] = Field(description="one for each session; empty if it lacks the property")


def find_differences(sessions: Sequence[tuple[SessionRow, ControlHistory]]) -> list[Difference]:
    """Return the properties in which sessions differ; for a single session all except its files."""
    alone = len(sessions) == 1
    groups = [
        ("In force", [dict(_in_force(history)) for _, history in sessions]),
        ("Parameters", [dict(_parameters(history)) for _, history in sessions]),
        ("Session", [_of_session(row, history) for row, history in sessions]),
    ]
    if not alone:
        known = all(history.crafts for _, history in sessions)
        groups += [
            ("Craft", [dict(_numbers(history)) if known else {} for _, history in sessions]),
            ("robot.toml", [dict(flatten(row.configuration)) for row, _ in sessions]),
            ("Scenario", [dict(flatten(row.scenario)) for row, _ in sessions]),
        ]
    differences: list[Difference] = []
    for group, columns in groups:
        for name in dict.fromkeys(name for column in columns for name in column):
            values = [column.get(name, "") for column in columns]
            if len(set(values)) > 1 or (alone and values[0]):
                differences.append(Difference(group=group, name=name, values=values))
    return differences


def flatten(text: str) -> Iterator[tuple[str, str]]:
    """Yield the entries of a TOML text, with dotted names; one entry with the problem if it is not valid."""
    try:
        yield from _entries("", read_toml(text))
    except TomlError as problem:
        yield "text", f"cannot be read: it {problem}"


def _entries(prefix: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _entries(f"{prefix}.{key}" if prefix else key, inner)
    elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        for number, inner in enumerate(value, 1):
            yield from _entries(f"{prefix} {number}", inner)
    else:
        yield prefix, _shown(value)


def _in_force(history: ControlHistory) -> Iterator[tuple[str, str]]:
    for key, title in _STATE.items():
        if key in history.state:
            yield title, _shown(history.state[key])
    times = [control.time for control in history.controls]
    used = [control for control in history.controls if _used_while_armed(control.time, times, history.armed)]
    controllers = list(dict.fromkeys(_name(control) for control in used))
    if controllers:
        yield "Controller", _sequence(controllers)
    gains: dict[str, list[str]] = {}
    for control in used:
        for name, value in control.gains.items():
            gains.setdefault(f"{_name(control)}: {name}", []).append(_shown(value))
    for name, values in gains.items():
        yield name, _sequence(list(dict.fromkeys(values)))


def _name(control: ControlPeriod) -> str:
    return control.title or control.controller


def _parameters(history: ControlHistory) -> Iterator[tuple[str, str]]:
    """Yield every parameter with its values while armed, in order of time."""
    times = [parameter.time for parameter in history.parameters]
    values: dict[str, list[str]] = {}
    for parameter in history.parameters:
        if _used_while_armed(parameter.time, times, history.armed):
            for name, value in parameter.values.items():
                values.setdefault(name, []).append(_shown(value))
    for name, seen in values.items():
        yield name, _sequence(list(dict.fromkeys(seen)))


def _numbers(history: ControlHistory) -> Iterator[tuple[str, str]]:
    """Yield every number of the craft, with those of later ones."""
    values: dict[str, list[str]] = {}
    for craft in history.crafts:
        for name, value in flatten(craft.file):
            if name not in ("title", "origin"):
                values.setdefault(name.removeprefix("craft."), []).append(value)
    for name, seen in values.items():
        yield name, ", then ".join(dict.fromkeys(seen))


def _used_while_armed(time: float, times: Sequence[float], armed: Sequence[Span]) -> bool:
    """Return True if the choice at `time`, one of `times`, is in force at any time while armed."""
    if not armed:
        return time == times[0]
    in_force = Span(time, min((later for later in times if later > time), default=float("inf")))
    return any(span.start < in_force.end and in_force.start < span.end for span in armed)


def _sequence(values: Sequence[str]) -> str:
    return values[0] if len(values) == 1 else CHANGED + ", ".join(values)


def _of_session(row: SessionRow, history: ControlHistory) -> dict[str, str]:
    values = {title: _shown(getattr(row, key)) for key, title in _ROW.items()}
    return values | {"Craft": describe_crafts(history.water, history.crafts)}


def _shown(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(_shown(item) for item in value)
    return str(value)
