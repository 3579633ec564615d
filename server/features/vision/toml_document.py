"""The settings as the table [vision] of robot.toml, and back."""

import tomllib
from typing import Any

import tomli_w

from robot_runtime.config import VisionConfig
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import read_value


def write_document(table: dict[str, Any]) -> str:
    """Settings, as `VisionSettings.table` gives them, as TOML."""
    return tomli_w.dumps({"vision": table})


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
