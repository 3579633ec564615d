"""The settings as the table [vision] of robot.toml, and back."""

import json
import tomllib
from collections.abc import Iterator
from typing import Any

from robot_runtime.config import VisionConfig
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse, read_value

BARE = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")


def write_document(table: dict[str, Any]) -> str:
    """Settings, as `VisionSettings.table` gives them, as TOML."""
    return "\n".join(_lines(table)) + "\n"


def read_document(text: str) -> dict[str, Any]:
    """The settings of the table [vision], as `VisionSettings.table` gives them; the rest is as usual.

    Raises ConfigError where there is none, or where it cannot be used.
    """
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise ConfigError(f"This is no TOML: {problem}.") from problem
    if "vision" not in document:
        raise ConfigError("There is no table [vision] in it.")
    # A whole robot.toml names the camera, too, which cannot be changed while the robot runs.
    config: VisionConfig = read_value(VisionConfig, document["vision"], "vision")
    return config.settings.table()


def check(table: dict[str, Any]) -> None:
    """Raises ConfigError where settings do not go together."""
    parse(VisionConfig, table)


def _lines(table: dict[str, Any]) -> Iterator[str]:
    nested = {name: value for name, value in table.items() if isinstance(value, dict)}
    yield "[vision]"
    for name, value in table.items():
        if name not in nested:
            yield f"{name} = {_value(value)}"
    if nested["actions"]:
        yield "\n[vision.actions]"
        for name, depth in nested["actions"].items():
            yield f"{_key(name)} = {_value(depth)}"
    for name, ranges in nested["colours"].items():
        yield f"\n[vision.colours.{_key(name)}]"
        for part, pair in ranges.items():
            yield f"{part} = {_value(pair)}"


def _key(name: str) -> str:
    return name if set(name) <= BARE else _value(name)


def _value(value: object) -> str:
    # JSON's numbers, lists and strings are TOML's, too.
    return json.dumps(value, ensure_ascii=False)
