"""The scenarios that ship with the program, and those of the data folder."""

import threading
from pathlib import Path

from robot_runtime.contract.limits import ConfigError
from robot_runtime.durable_files import make_folder, write_whole
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario, read_scenario
from robot_runtime.experiments.scenario.library import SHIPPED, shipped_scenarios
from server.features.scenarios.schemas import ScenarioText, summarize
from server.library.scenarios import own_scenarios
from server.platform.disk_space import FileWriteError, explain_write_error
from server.platform.edited_meanwhile import ChangedMeanwhileError, mark_text

SCENARIOS_MAX = 200
"""Of the data folder."""
_STORING = threading.Lock()
"""Held while a scenario is compared and written: each request has a thread."""


def list_scenarios(own: Path) -> list[ScenarioText]:
    """Return the shipped scenarios, then those in the folder `own` by name; unreadable files are left out."""
    return [_describe(name, text, shipped=True) for name, text in shipped_scenarios().items()] + [
        _describe(file.stem, text, shipped=False) for file, text in own_scenarios(own)
    ]


def keep_scenario(own: Path, text: str, base: str | None = None) -> Scenario:
    """Write a scenario into the folder `own`, under its own name.

    `base` is the mark (`mark_text`) of the text that the editing began from, "" for a new scenario; None
    replaces any. Raise ConfigError if it is not valid, RefusedError if it may not be written,
    ChangedMeanwhileError, FileWriteError.
    """
    scenario = read_scenario(text)
    if scenario.name in SHIPPED:
        raise RefusedError(f"{scenario.name} ships with the program. Choose another name.")
    path = own / f"{scenario.name}.toml"
    with _STORING:
        stored = dict(own_scenarios(own))
        there = stored.get(path, "")
        if base is not None and text != there and base != mark_text(there):
            raise ChangedMeanwhileError(f"The scenario {scenario.name}", "", gone=not there)
        if path not in stored and len(stored) >= SCENARIOS_MAX:
            raise RefusedError(f"There are {SCENARIOS_MAX} scenarios already. Remove one from {own}.")
        try:
            make_folder(own)
            write_whole(path, text.encode())
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, path)) from problem
    return scenario


def _describe(name: str, text: str, shipped: bool) -> ScenarioText:
    """Return the scenario; the title of an invalid one is its file's name."""
    try:
        summary = summarize(read_scenario(text))
    except ConfigError:
        summary = None
    title = summary.title if summary else name
    return ScenarioText(
        name=name, title=title, text=text, mark=mark_text(text), shipped=shipped, summary=summary
    )
