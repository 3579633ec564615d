"""The leaves and branches as the page's editor shows them, from their classes."""

from dataclasses import MISSING, Field, fields
from inspect import cleandoc
from typing import Any, Literal

from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.missions import leaves  # noqa: F401 - declares them
from robot_runtime.missions.branches import CallBranch
from robot_runtime.missions.leaf import NODES, Branch, MissionNode
from server.features.missions.schemas import MissionNodeKind, NodeField

FieldKind = Literal["number", "whole", "text", "value", "sight", "parameter", "mission"]


def list_node_kinds() -> list[MissionNodeKind]:
    """Return every leaf and branch that documents may have."""
    return [_describe(do, cls) for do, cls in NODES.items()]


def _describe(do: str, cls: type[MissionNode]) -> MissionNodeKind:
    branch = issubclass(cls, Branch)
    hints = read_fields(cls)
    return MissionNodeKind(
        do=do,
        branch=branch,
        least=cls.least if issubclass(cls, Branch) else 0,
        most=cls.most if issubclass(cls, Branch) else 0,
        meaning=cleandoc(cls.__doc__ or "").replace("\n", " "),
        fields=[
            _describe_field(field, hints[field.name], cls)
            for field in fields(cls)
            if field.init and field.name != "note"
        ],
    )


def _describe_field(field: "Field[Any]", hint: Hint, cls: type[MissionNode]) -> NodeField:
    limits = next((member.limits for member in hint.members if member.limits is not None), hint.limits)
    default = None if field.default is MISSING else field.default
    kind: FieldKind = field.metadata.get("kind") or ("mission" if cls is CallBranch else _kind(hint))
    return NodeField(
        name=field.name,
        kind=kind,
        meaning=field.metadata.get("description", ""),
        unit=field.metadata.get("unit", ""),
        minimum=limits.minimum if limits else None,
        maximum=limits.maximum if limits else None,
        required=field.default is MISSING,
        default=default,
    )


def _kind(hint: Hint) -> FieldKind:
    forms = [member.form for member in hint.members]
    if len(forms) > 1:
        return "value"
    return "whole" if forms == ["whole number"] else "number" if forms == ["number"] else "text"
