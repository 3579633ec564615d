"""The kinds of a scenario's events as the page's editor shows them, from their classes."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from inspect import cleandoc
from typing import Any, get_args

from robot_runtime.contract.card_colours import MARKER_CARD
from robot_runtime.contract.commands import CardCommand, ControllerCommand, LoopCommand, VisionCommand
from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.contract.vision_settings import marker_name
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.experiments.scenario.events import EVENTS, Colour
from robot_runtime.simulation.water.faults import SENSORS
from robot_runtime.simulation.water.requests import SensorFaultRequest
from server.features.scenarios.schemas import EventField, EventFieldKind, ScenarioEventKind

_DEPTH = tuple(kind.name for kind in CONTROLLERS["depth"])
_CHOICES: Mapping[tuple[type, str], tuple[str, ...]] = {
    (CardCommand, "colour"): (*get_args(Colour), marker_name(MARKER_CARD)),
    (VisionCommand, "colour"): get_args(Colour),
    (ControllerCommand, "name"): _DEPTH,
    (LoopCommand, "controller"): tuple(
        dict.fromkeys(kind.name for kinds in CONTROLLERS.values() for kind in kinds)
    ),
    (SensorFaultRequest, "sensor"): SENSORS,
}
"""The values of texts that `read_event` accepts, and no type says."""
_KINDS: Mapping[str, EventFieldKind] = {
    "number": "number",
    "whole number": "whole",
    "text": "text",
    "switch": "switch",
    "choice": "choice",
}


def list_event_kinds() -> list[ScenarioEventKind]:
    """Return every kind of event that a scenario may have."""
    return [_describe(do, cls) for do, cls in EVENTS.items()]


def _describe(do: str, cls: type) -> ScenarioEventKind:
    hints = read_fields(cls)
    return ScenarioEventKind(
        do=do,
        meaning=cleandoc(cls.__doc__ or "").partition("\n\n")[0].replace("\n", " ").partition(" Raises ")[0],
        fields=[
            _describe_field(field, hints[field.name], cls)
            for field in fields(cls)
            if field.init and field.name != "at"
        ],
    )


def _describe_field(field: "Field[Any]", hint: Hint, cls: type) -> EventField:
    members = hint.members
    limits = next((member.limits for member in members if member.limits is not None), hint.limits)
    choices = _CHOICES.get((cls, field.name)) or tuple(c for member in members for c in member.choices)
    forms = {member.form for member in members}
    return EventField(
        name=field.name,
        kind="choice" if choices else _KINDS.get(forms.pop(), "value") if len(forms) == 1 else "value",
        choices=[str(choice) for choice in choices],
        meaning=field.metadata.get("description", ""),
        minimum=limits.minimum if limits else None,
        maximum=limits.maximum if limits else None,
        required=field.default is MISSING and field.default_factory is MISSING,
    )
