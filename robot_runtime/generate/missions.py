"""docs/reference/missions.md: what the document of a mission may contain, from the classes of its steps."""

import json
import typing
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields

from robot_runtime.contract.hints import read_fields
from robot_runtime.contract.missions import LEVELS_MAX, NODES_MAX
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.generate.markdown import page, table
from robot_runtime.generate.reference import describe_type
from robot_runtime.missions.document import DESCRIPTION_MAX, TITLE_MAX
from robot_runtime.missions.leaf import NODES, NOTE_MAX, Branch, Leaf, MissionNode

SOURCE = "the classes of the steps (robot_runtime/missions)"
INTRODUCTION = f"""\
A mission is a TOML document of at most {BYTES_MAX // 1000} kB. It is read strictly: an entry that is not
known is a problem, and all problems are told at once, each with its step. A step's place counts from 1 along
the branches: 3.1.2 is the second step of the first step of the third. [Missions](../use/missions.md) says how
to write, try and start one; [Add a leaf](../develop/add-a-leaf.md) how to add a step.
"""
DOCUMENT = (
    ("`format`", "1", "required"),
    ("`name`", "1 to 60 small letters, digits, - and _; it names the file", "required"),
    ("`title`", f"at most {TITLE_MAX} characters", "the name"),
    ("`description`", f"at most {DESCRIPTION_MAX} characters", ""),
    ("`alone`", "s for which it goes on without the server", "0"),
    ("`pause`", "s that it may be paused in all", "60"),
    ("`[limits]`", "what ends it, see below", "those of the robot"),
    ("`[mission]`", "the first step", "required"),
    ("`[trial]`", "its simulated water, as in a [scenario](../use/scenarios.md#write-one)", "a pool of 3 m"),
)
LIMITS = (
    ("`depth`", "m", "it ends below this; no step may ask for more"),
    ("`time`", "s", "it ends after this; the steps' longest time must fit"),
    ("`battery`", "V", "it ends when the battery stays below this; it needs a battery that is measured"),
    ("`unwatched`", "s", "it ends when no operator's page was open for so long"),
)
LIMITS_INTRODUCTION = """\
A document only tightens the limits of [`[missions]` in `robot.toml`](configuration.md#missions). They are
checked at every tick of the control loop, beside the steps.
"""
STEPS = f"""\
`do` names the step. A branch has its steps in `steps`, a list of tables. Each step may have a `note`, a
remark of at most {NOTE_MAX} characters. A mission has at most {NODES_MAX} steps with those of the missions
that it calls, and at most {LEVELS_MAX} levels. Steps that run side by side must not steer the same: depth,
heading or course. A [swim](#swim) without `yaw` leaves the heading alone.
"""


def missions_page() -> str:
    """Return the whole text of missions.md."""
    leaves = [cls for cls in NODES.values() if issubclass(cls, Leaf)]
    branches = [cls for cls in NODES.values() if issubclass(cls, Branch)]
    parts = [
        INTRODUCTION,
        "## The document\n",
        table(("entry", "content", "without it"), DOCUMENT),
        "## Limits\n",
        LIMITS_INTRODUCTION,
        table(("in `[limits]`", "unit", "meaning"), LIMITS),
        "## Steps\n",
        STEPS,
        table(("leaf", "steers", "meaning"), map(_leaf_row, leaves)),
        table(("branch", "steps", "meaning"), map(_branch_row, branches)),
    ]
    for cls in (*leaves, *branches):
        parts += [f"## {cls.do}\n", f"{_meaning(cls)}\n"]
        if rows := list(_field_rows(cls)):
            parts.append(table(("field", "type", "unit", "without it", "meaning"), rows))
    return page("Missions", SOURCE, *parts)


def _leaf_row(cls: type[Leaf]) -> tuple[str, ...]:
    return f"[{cls.do}](#{cls.do})", ", ".join(sorted(cls.claims)), _first_sentence(cls)


def _branch_row(cls: type[Branch]) -> tuple[str, ...]:
    count = f"{cls.least}" if cls.most == cls.least else f"{cls.least} at least"
    return f"[{cls.do}](#{cls.do})", count, _first_sentence(cls)


def _field_rows(cls: type[MissionNode]) -> Iterator[tuple[str, ...]]:
    hints = read_fields(cls)
    for field in fields(cls):
        if field.name != "note":
            unit, meaning = field.metadata.get("unit", ""), field.metadata.get("description", "")
            yield f"`{field.name}`", describe_type(hints[field.name]), unit, _default(field), meaning


def _default(field: "Field[typing.Any]") -> str:
    if field.default is MISSING:
        return "required"
    if field.default is None:
        return ""
    # Texts and switches as in TOML, which here are those of JSON.
    return f"{field.default:g}" if isinstance(field.default, float) else json.dumps(field.default)


def _meaning(cls: type[MissionNode]) -> str:
    return " ".join((cls.__doc__ or "").split())


def _first_sentence(cls: type[MissionNode]) -> str:
    return _meaning(cls).split(". ")[0].rstrip(".") + "."
