"""The texts of the scenarios: those that ship with the program, and those of the data folder."""

import logging
from pathlib import Path

from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.experiments.scenario.library import shipped_scenarios

log = logging.getLogger(__name__)


def own_scenarios(folder: Path) -> list[tuple[Path, str]]:
    """Return the files of a folder with their texts, by name; unreadable ones are left out."""
    texts = []
    for file in sorted(folder.glob("*.toml")):
        try:
            if file.stat().st_size <= BYTES_MAX:
                texts.append((file, load_text(file)))
        except OSError as problem:
            log.warning("the scenario %s cannot be read: %s", file, problem)
        except TextError as problem:
            log.warning("the scenario %s cannot be read: it %s", file, problem)
    return texts


def scenario_texts(own: Path) -> dict[str, str]:
    """Return the texts of all scenarios by name: the shipped ones, then those of the folder `own`."""
    shipped = shipped_scenarios()
    return shipped | {file.stem: text for file, text in own_scenarios(own) if file.stem not in shipped}
