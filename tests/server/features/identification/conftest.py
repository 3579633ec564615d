"""Two short sessions of the sea trial on a craft that is not the default, and a fit that is quickly done."""

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from robot_runtime.experiments.identification import fit
from robot_runtime.experiments.scenario.library import shipped_scenarios
from server.cli import main
from server.platform.settings import DataFolder

CRAFT = """
title = "Another craft"
[craft]
fin_drag = 0.22
buoyancy_height = 0.0085
"""
SECONDS = 19


@dataclass(frozen=True)
class RecordedTrials:
    """A data folder with sessions 1 and 2, and a configuration with the default craft."""

    data: DataFolder
    config: Path


@pytest.fixture(scope="session")
def trials() -> Iterator[RecordedTrials]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        yield record(Path(name))


def record(folder: Path) -> RecordedTrials:
    """Swim both sessions into the data folder there."""
    (folder / "other.toml").write_text(CRAFT)
    (folder / "swum.toml").write_text('[craft]\nfile = "other.toml"\n')
    (folder / "robot.toml").write_text("")
    text = shipped_scenarios()["sea_trial"].replace("duration = 120", f"duration = {SECONDS}")
    head, *events = text.split("[[events]]")
    early = [event for event in events if float(event.split("at = ")[1].split()[0]) < SECONDS]
    data = DataFolder(folder / "data")
    for seed in (1, 2):
        path = folder / f"trial{seed}.toml"
        path.write_text("[[events]]".join([head.replace("seed = 1", f"seed = {seed}"), *early]))
        where = ["--data", str(data.path), "--config", str(folder / "swum.toml")]
        assert main(["scenario", "run", str(path), *where]) == 0
    return RecordedTrials(data, folder / "robot.toml")


@pytest.fixture
def quick_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few steps: how exact a fit is, tests/runtime/experiments/identification shows."""
    monkeypatch.setattr(fit, "ROUNDS", 2)
    monkeypatch.setattr(fit, "STEPS_MAX", 3)
