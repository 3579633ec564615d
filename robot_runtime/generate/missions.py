"""docs/reference/missions.md: what the document of a mission may contain, from the classes of its steps."""

import json
import typing
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields

from robot_runtime.contract.hints import read_fields
from robot_runtime.contract.missions import LEVELS_MAX, NODES_MAX
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.generate.markdown import entry, fill, page, table
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
    leaves: list[type[Leaf]] = [cls for cls in NODES.values() if issubclass(cls, Leaf)]
    branches: list[type[Branch]] = [cls for cls in NODES.values() if issubclass(cls, Branch)]
    text = fill(
        "missions",
        kilobytes=BYTES_MAX // 1000,
        note=NOTE_MAX,
        nodes=NODES_MAX,
        levels=LEVELS_MAX,
        document=table(("entry", "content", "without it"), DOCUMENT),
        limits=table(("in `[limits]`", "unit", "meaning"), LIMITS),
        leaves=", ".join(f"[{cls.do}](#{cls.do})" for cls in leaves),
        branches=", ".join(f"[{cls.do}](#{cls.do})" for cls in branches),
    )
    parts = [text]
    rules: dict[type[MissionNode], str] = {
        **{leaf: _steers(leaf) for leaf in leaves},
        **{branch: _steps(branch) for branch in branches},
    }
    for cls, rule in rules.items():
        parts += [f"## {cls.do}\n", f"{_meaning(cls)} {rule}\n"]
        if lines := "".join(_field_lines(cls)):
            parts.append(lines)
    return page("Missions", SOURCE, *parts)


def _steers(cls: type[Leaf]) -> str:
    return f"Steers: {', '.join(sorted(cls.claims)) or 'nothing'}."


def _steps(cls: type[Branch]) -> str:
    return f"Steps: {cls.least}{'' if cls.most == cls.least else ' at least'}."


def _field_lines(cls: type[MissionNode]) -> Iterator[str]:
    hints = read_fields(cls)
    for field in fields(cls):
        if field.name != "note":
            unit, meaning = field.metadata.get("unit", ""), field.metadata.get("description", "")
            type_ = " ".join(filter(None, (describe_type(hints[field.name]), unit)))
            yield entry(field.name, (type_, _default(field)), meaning)


def _default(field: "Field[typing.Any]") -> str:
    if field.default is MISSING:
        return "required"
    if field.default is None:
        return ""
    # Texts and switches as in TOML, which here are those of JSON.
    text = f"{field.default:g}" if isinstance(field.default, float) else json.dumps(field.default)
    return f"without it {text}"


def _meaning(cls: type[MissionNode]) -> str:
    return " ".join((cls.__doc__ or "").split())
