"""The kinds of events that the page offers: each with its fields, and a chosen value is accepted."""

from typing import Any

import pytest

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import TOP
from robot_runtime.experiments.scenario.events import EVENTS, read_event
from server.features.scenarios.event_kinds import list_event_kinds

KINDS = {kind.do: kind for kind in list_event_kinds()}


def test_every_event_has_a_kind_with_a_meaning() -> None:
    assert list(KINDS) == list(EVENTS)
    assert all(kind.meaning.endswith(".") or kind.meaning for kind in KINDS.values())
    colour, *_ = KINDS["card"].fields
    assert (colour.kind, colour.required, colour.choices[:2]) == ("choice", False, ["red", "yellow"])
    assert [(field.name, field.kind) for field in KINDS["line"].fields][:3] == [
        ("direction", "choice"),
        ("kind", "choice"),
        ("rate", "number"),
    ]
    assert {field.name: field.kind for field in KINDS["loop"].fields}["on"] == "switch"
    assert {field.name: field.kind for field in KINDS["beacons"].fields} == {"positions": "value"}


@pytest.mark.parametrize("do", ["card", "vision", "controller", "mode", "steering"])
def test_each_offered_choice_is_accepted(do: str) -> None:
    field = next(field for field in KINDS[do].fields if field.choices)
    for choice in field.choices:
        assert read_event({"at": 1.0, "do": do, field.name: choice}, TOP).do == do
    with pytest.raises(ConfigError):
        read_event({"at": 1.0, "do": do, field.name: "purple"}, TOP)


def test_each_sensor_can_be_mended() -> None:
    sensors = next(field for field in KINDS["fault"].fields if field.name == "sensor").choices
    for sensor in sensors:
        event: Any = read_event({"at": 1.0, "do": "fault", "sensor": sensor, "kind": "none"}, TOP)
        assert event.change.sensor == sensor
