"""docs/reference/configuration.md: every entry of robot.toml.

Names, values and defaults are those of the configuration's dataclasses; their summaries introduce the
sections. The meaning of an entry is the comment beside it in robot.toml, so that file and page say the same.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields

from robot_runtime.config import Config
from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.generate.markdown import entry, fill, page
from server.feature import list_features
from server.platform.server_config import ServerConfig

SOURCE = "the classes of the sections and the comments of robot.toml"
TABLES = {
    "gains": "gains of each controller; [Parameters](parameters.md) lists them",
    "actions": "set point (m) while a colour or marker is seen",
    "colours": "hue, saturation and value of each colour; [Vision](../use/vision.md#colours) explains them",
}
"""The meaning of entries that are tables of their own."""
_HEADER = re.compile(r"\[(.+?)\]")
_ENTRY = re.compile(r"(\w+) = [^#]*(?:# (.*))?")
_CONTINUED = re.compile(r"\s+# (.*)")


def configuration_page(robot_toml: str) -> str:
    """Return the whole text of configuration.md.

    Raise ValueError where an entry has no comment in `robot_toml`.
    """
    meanings = read_comments(robot_toml)
    parts = [fill("configuration")]
    for name, cls in list_sections().items():
        summary = (cls.__doc__ or "").partition("\n\n")[0]
        parts += [f"## `[{name}]`\n", " ".join(summary.split()) + "\n"]
        parts.append("".join(_list_entries(cls, name, cls(), meanings)))
    return page("Configuration", SOURCE, *parts)


def list_sections() -> dict[str, type]:
    """Return the classes of all sections: the robot's, the server's, the features'."""
    return {
        **{field.name: type(field.default) for field in fields(Config)},
        "server": ServerConfig,
        **{
            feature.name: section
            for feature in list_features().values()
            if (section := feature.section_class) is not None
        },
    }


def read_comments(text: str) -> dict[str, str]:
    """Return the comment of each entry of a TOML file, by `section.entry`; continued lines are joined."""
    section, entry = "", ""
    comments: dict[str, str] = {}
    for line in text.splitlines():
        if header := _HEADER.match(line):
            section, entry = header[1], ""
        elif match := _ENTRY.match(line):
            entry = f"{section}.{match[1]}"
            comments[entry] = match[2] or ""
        elif (more := _CONTINUED.match(line)) and entry:
            comments[entry] += f" {more[1]}"
    return comments


def _list_entries(cls: type, section: str, defaults: object, meanings: Mapping[str, str]) -> Iterator[str]:
    hints = read_fields(cls)
    for field in fields(cls):
        meaning = TABLES.get(field.name) or meanings.get(f"{section}.{field.name}")
        if not meaning:
            raise ValueError(f"robot.toml has no comment beside {section}.{field.name}; add one")
        default = getattr(defaults, field.name)
        shown = (
            ""
            if field.name in TABLES or field.default is MISSING is field.default_factory
            else _toml(default)
        )
        yield entry(field.name, (_values(hints[field.name]), shown and f"default {shown}"), meaning)


def _values(hint: Hint) -> str:
    """Return the values that a type hint admits, as text."""
    if hint.limits is not None:
        return f"{hint.limits.minimum:g} to {hint.limits.maximum:g}"
    if hint.form == "choice":
        return ", ".join(f"`{value}`" for value in hint.choices)
    return "true or false" if hint.form == "switch" else "list" if hint.form == "tuple" else hint.form


def _toml(value: object) -> str:
    return f"`{json.dumps(value, ensure_ascii=False)}`"
