"""Identification: crafts that differ from the default by up to 40 % in every number, from their sea trials.

A sea trial is the scenario that people record for it, with the robot's own firmware, motors and recorder.
"""

import os
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np
import tomli_w

from bench.measurement import MeasurementError
from robot_runtime.contract.craft import Craft, craft_table
from robot_runtime.experiments.identification.identify import identify
from robot_runtime.experiments.identification.streams import SessionStreams
from robot_runtime.experiments.scenario.library import shipped_scenarios
from server.cli import main
from server.features.identification.sessions import read_streams
from server.platform.settings import DataFolder
from server.platform.store import Reader
from tests.runtime.experiments.identification.swimmer import random_craft

_CRAFTS = 8
_TRIALS = 4
"""Sessions of a fit, of 120 s each; one more is left out."""


@dataclass(frozen=True, slots=True)
class _Found:
    errors: list[float]
    """Relative errors of the numbers that are seen well."""
    weak: list[float]
    distances: list[float]
    """Errors over their standard deviations."""
    unseen: int
    gain: float
    seconds: float
    """Processor time of the fit."""


def _record(craft: Craft, first_seed: int) -> list[SessionStreams]:
    """Return the streams of the sea trials of this craft."""
    trial = shipped_scenarios()["sea_trial"]
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder, data = Path(name), DataFolder(Path(name) / "data")
        (folder / "true.toml").write_text(tomli_w.dumps({"title": "True", "craft": craft_table(craft)}))
        (folder / "robot.toml").write_text('[craft]\nfile = "true.toml"\n')
        for seed in range(first_seed, first_seed + _TRIALS + 1):
            path = folder / f"{seed}.toml"
            path.write_text(trial.replace("\nseed = 1\n", f"\nseed = {seed}\n"))
            where = ["--data", str(data.path), "--config", str(folder / "robot.toml")]
            with redirect_stdout(StringIO()):
                status = main(["scenario", "run", str(path), *where])
            if status:
                raise MeasurementError(f"sea trial {seed} ended with {status}")
        store = Reader(data.database)
        return [read_streams(store, session) for session in range(1, _TRIALS + 2)]


def _identify(number: int) -> _Found:
    true = random_craft(number)
    trials = _record(true, 100 * number)
    began = time.process_time()
    identification = identify(trials[:-1], trials[-1], Craft())
    seconds = time.process_time() - began
    errors: dict[str, list[float]] = {"well": [], "weakly": [], "no": []}
    distances = []
    for result in identification.results:
        value = result.quantity.value(true)
        size = abs(value - 1) if result.quantity.name == "buoyancy" else abs(value)
        errors[result.seen].append(abs(result.value - value) / size)
        if result.deviation is not None:
            distances.append(abs(result.value - value) / result.deviation)
    assert identification.prediction is not None
    gain = identification.prediction.improvement
    return _Found(errors["well"], errors["weakly"], distances, len(errors["no"]), gain, seconds)


def measure() -> dict[str, float]:
    """Return the worst figures of several crafts, and the medians of their numbers."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = list(pool.map(_identify, range(1, _CRAFTS + 1)))
    well = [error for run in runs for error in run.errors]
    weak = [error for run in runs for error in run.weak]
    distances = [distance for run in runs for distance in run.distances]
    return {
        "identify.error_percent_max": 100 * max(well),
        "identify.error_percent_median": 100 * float(np.median(well)),
        "identify.weak_error_percent_max": 100 * max(weak, default=0.0),
        "identify.weak_share_percent": 100 * len(weak) / (len(well) + len(weak)),
        "identify.unseen_max": max(run.unseen for run in runs),
        "identify.deviations_p95": float(np.percentile(distances, 95)),
        "identify.prediction_gain_min": min(run.gain for run in runs),
        "identify.seconds_median": float(np.median([run.seconds for run in runs])),
    }
