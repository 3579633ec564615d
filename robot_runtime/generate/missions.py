"""docs/reference/missions.md: what the document of a mission may contain, from the classes of its steps."""

import json
import typing
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields

from robot_runtime.contract.hints import read_fields
from robot_runtime.contract.missions import LEVELS_MAX, NODES_MAX
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.generate.markdown import fill, page, table
from robot_runtime.generate.reference import describe_type
from robot_runtime.missions.document import DESCRIPTION_MAX, TITLE_MAX
from robot_runtime.missions.leaf import NODES, NOTE_MAX, Branch, Leaf, MissionNode

SOURCE = "the classes of the steps (robot_runtime/missions)"
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


def missions_page() -> str:
    """Return the whole text of missions.md."""
    leaves = [cls for cls in NODES.values() if issubclass(cls, Leaf)]
    branches = [cls for cls in NODES.values() if issubclass(cls, Branch)]
    text = fill(
        "missions",
        kilobytes=BYTES_MAX // 1000,
        note=NOTE_MAX,
        nodes=NODES_MAX,
        levels=LEVELS_MAX,
        document=table(("entry", "content", "without it"), DOCUMENT),
        limits=table(("in `[limits]`", "unit", "meaning"), LIMITS),
        leaves=table(("leaf", "steers", "meaning"), map(_leaf_row, leaves)),
        branches=table(("branch", "steps", "meaning"), map(_branch_row, branches)),
    )
    parts = [text]
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
