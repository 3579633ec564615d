"""The missions that ship with the program."""

from functools import cache
from importlib.resources import files

SHIPPED = (
    "first_dive",
    "two_depths",
    "follow_colour",
    "search_marker",
    "light_and_back",
    "three_lanes",
    "endurance",
)
"""The shipped missions, the simplest first."""


@cache
def shipped_missions() -> dict[str, str]:
    """Return the texts of the shipped missions by name."""
    folder = files("robot_runtime.missions") / "shipped"
    return {name: (folder / f"{name}.toml").read_text(encoding="utf-8") for name in SHIPPED}
