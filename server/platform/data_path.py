"""The path of the data folder, and names in it: without the settings, which take long to load."""

from collections.abc import Mapping
from pathlib import Path

DATABASE = "mucat.db"
SCENARIOS = "scenarios"
MISSIONS = "missions"


def data_path(data: Path | None, environment: Mapping[str, str]) -> Path:
    """Return the path of the data folder named by the command line, else by the environment."""
    return (data or Path(environment.get("MUCAT_DATA") or "data")).absolute()
