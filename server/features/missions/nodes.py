"""The leaves and branches as the page's editor shows them, from their classes."""

import types
from dataclasses import MISSING, Field, fields
from inspect import cleandoc
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.limits import Range
from robot_runtime.missions import leaves  # noqa: F401 - declares them
from robot_runtime.missions.branches import CallBranch
from robot_runtime.missions.leaf import NODES, Branch, MissionNode
from server.features.missions.schemas import MissionNodeKind, NodeField

FieldKind = Literal["number", "whole", "text", "value", "sight", "parameter", "mission"]


def list_node_kinds() -> list[MissionNodeKind]:
    """Every leaf and branch that documents may have."""
    return [_describe(do, cls) for do, cls in NODES.items()]


def _describe(do: str, cls: type[MissionNode]) -> MissionNodeKind:
    branch = issubclass(cls, Branch)
    hints = get_type_hints(cls, include_extras=True)
    return MissionNodeKind(
        do=do,
        branch=branch,
        least=cls.least if issubclass(cls, Branch) else 0,
        most=cls.most if issubclass(cls, Branch) else 0,
        meaning=cleandoc(cls.__doc__ or "").replace("\n", " "),
        fields=[
            _describe_field(one, hints[one.name], cls)
            for one in fields(cls)
            if one.init and one.name != "note"
        ],
    )


def _describe_field(one: "Field[Any]", hint: Any, cls: type[MissionNode]) -> NodeField:
    limits = _limits(hint)
    default = None if one.default is MISSING else one.default
    kind: FieldKind = one.metadata.get("kind") or ("mission" if cls is CallBranch else _kind(hint))
    return NodeField(
        name=one.name,
        kind=kind,
        meaning=one.metadata.get("description", ""),
        unit=one.metadata.get("unit", ""),
        minimum=limits.minimum if limits else None,
        maximum=limits.maximum if limits else None,
        required=one.default is MISSING,
        default=default,
    )


def _limits(hint: Any) -> Range | None:
    if get_origin(hint) is Annotated:
        return next((one for one in get_args(hint)[1:] if isinstance(one, Range)), None)
    if get_origin(hint) in (types.UnionType, Union):
        return next((found for one in get_args(hint) if (found := _limits(one)) is not None), None)
    return None


def _kind(hint: Any) -> FieldKind:
    if get_origin(hint) is Annotated:
        return _kind(get_args(hint)[0])
    if get_origin(hint) in (types.UnionType, Union):
        kinds = [one for one in get_args(hint) if one is not types.NoneType]
        return _kind(kinds[0]) if len(kinds) == 1 else "value"
    return "whole" if hint is int else "number" if hint is float else "text"
