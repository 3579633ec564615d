"""The order of a sweep to the process that computes it."""

from collections.abc import Mapping

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import TOP
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.experiments.sweep.document import Sweep, check_variants, read_sweep
from server.analysis.definitions import RUN_FIGURES
from server.features.sweeps.search import NO_SCIPY, can_search
from server.platform.schema_base import Schema

FIGURES = {meaning.name: meaning.better != "neither" for meaning in RUN_FIGURES}


class SweepOrder(Schema):
    """A sweep with the scenario and the robot's craft file at its start, and who computes it."""

    text: str
    scenario: str
    craft: str
    scheduler: str
    certificates: str
    workers: int


def read_document(text: str, scenarios: Mapping[str, str], craft: Craft) -> Sweep:
    """Return the sweep of a text, checked. Raise ConfigError with all problems."""
    sweep = read_sweep(text, scenarios, FIGURES)
    if sweep.search is not None and not can_search():
        raise ConfigError(TOP.field("search").sentence(NO_SCIPY))
    check_variants(sweep, craft)
    return sweep


def reopen(text: str, scenario: str) -> Sweep:
    """Return a sweep that was checked at its start, by its text and its scenario's. Raise ConfigError."""
    return read_sweep(text, {_scenario_name(text): scenario}, FIGURES)


def _scenario_name(text: str) -> str:
    try:
        return str(read_toml(text).get("scenario", ""))
    except TomlError:
        return ""
