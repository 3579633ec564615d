"""The scenarios that ship with the program."""

from importlib.resources import files

SHIPPED = (
    "figure_14",
    "changing_cards",
    "hover_in_a_current",
    "beacon_approach",
    "sensor_failure",
    "lost_link",
    "sea_trial",
)
"""The shipped scenarios, the thesis's own first."""


def shipped_scenarios() -> dict[str, str]:
    """Return the texts of the shipped scenarios by name."""
    folder = files("robot_runtime.experiments.scenario") / "shipped"
    return {name: (folder / f"{name}.toml").read_text(encoding="utf-8") for name in SHIPPED}
