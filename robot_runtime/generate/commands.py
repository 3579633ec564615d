"""docs/reference/commands.md: every command to the robot."""

import dataclasses
import types
import typing
from collections.abc import Iterator
from typing import Any

from robot_runtime.contract.commands import COMMANDS, RobotCommand, StopCommand, http_commands, is_required
from robot_runtime.contract.limits import Range
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/contract/commands.py"
INTRODUCTION = """\
Programs and the page send a command as `POST /api/robot/commands/NAME` with its fields as a JSON object;
fields that are optional may be left out. STOP has a faster way of its own, `POST /api/robot/stop`, and is
never refused. A command whose column *HTTP* is empty is sent by the server and by scenarios only. Scenarios
name a command in `do`. What a command changes about parameters is noted in their history, with the person who
sent it, and can be undone. While an experiment measures a loop, commands that would disturb it are refused.

The runtime checks every command again and answers why it refuses one. Between server and runtime a command
travels as a Zenoh query to `command/NAME`.
"""
_WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}


def commands_page() -> str:
    """The whole text of commands.md."""
    head = ("command", "HTTP", "needs", "scenarios", "history", "during an experiment")
    parts = [INTRODUCTION, table(head, map(_summary, COMMANDS.values()))]
    for name, cls in COMMANDS.items():
        parts += [f"## {name}\n", f"{' '.join((cls.__doc__ or '').split())}\n"]
        if rows := list(_fields(cls)):
            parts.append(table(("field", "type", "", "meaning"), rows))
    return page("Commands", SOURCE, *parts)


def _summary(cls: type[RobotCommand]) -> tuple[str, ...]:
    policy = cls.policy
    way = "`POST /api/robot/stop`" if cls is StopCommand else "yes" if cls in http_commands() else ""
    return (
        f"[{policy.name}](#{policy.name})",
        way,
        "" if policy.need is None else policy.need.name.lower(),
        "yes" if policy.in_scenarios else "",
        "yes" if policy.tunes else "",
        "refused" if policy.disturbs_experiment else "",
    )


def _fields(cls: type[RobotCommand]) -> Iterator[tuple[str, ...]]:
    hints = typing.get_type_hints(cls, include_extras=True)
    for one in dataclasses.fields(cls):
        need = "" if is_required(one) else "optional"
        yield f"`{one.name}`", describe_type(hints[one.name]), need, one.metadata.get("description", "")


def describe_type(hint: Any) -> str:
    """A field's type in words, with its limits."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        span = next((one for one in inner[1:] if isinstance(one, Range)), None)
        limits = f", {span.minimum:.4g} to {span.maximum:.4g}" if span else ""
        return describe_type(inner[0]) + limits
    if origin is typing.Literal:
        return " or ".join(f"`{one}`" for one in inner)
    if origin in (types.UnionType, typing.Union):
        return " or ".join(dict.fromkeys(describe_type(one) for one in inner if one is not types.NoneType))
    if origin in (list, tuple):
        kinds = dict.fromkeys(describe_type(one) for one in inner if one is not Ellipsis)
        return f"list of {' and '.join(kinds)}"
    if origin is dict:
        return f"{describe_type(inner[1])}, by name"
    return _WORDS.get(hint) or f"`{hint.__name__}`"
