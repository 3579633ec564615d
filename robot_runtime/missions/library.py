"""The missions that ship with the program."""

from functools import cache
from importlib.resources import files

SHIPPED = (
    "two_depths",
    "follow_colour",
    "search_marker",
    "light_and_back",
    "pool_survey",
    "endurance",
)
"""The shipped missions, the simplest first."""


@cache
def shipped_missions() -> dict[str, str]:
    """Returns their texts by name."""
    folder = files("robot_runtime.missions") / "shipped"
    return {name: (folder / f"{name}.toml").read_text(encoding="utf-8") for name in SHIPPED}
