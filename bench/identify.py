"""Identification: crafts that differ from the default by up to 40 % in every number, from their own swims."""

import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.identify import identify
from tests.runtime.experiments.identification.swimmer import random_craft, swim

_CRAFTS = 8
_SWIMS, _SECONDS = 5, 60.0
"""Sessions of a fit, and the length of each; one more is left out."""


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


def _identify(number: int) -> _Found:
    true = random_craft(number)
    swims = [swim(true, 100 * number + one, _SECONDS) for one in range(_SWIMS + 1)]
    began = time.process_time()
    found = identify(swims[:-1], swims[-1], Craft())
    seconds = time.process_time() - began
    errors: dict[str, list[float]] = {"well": [], "weakly": [], "no": []}
    distances = []
    for one in found.results:
        value = one.quantity.value(true)
        size = abs(value - 1) if one.quantity.name == "buoyancy" else abs(value)
        errors[one.seen].append(abs(one.value - value) / size)
        if one.deviation is not None:
            distances.append(abs(one.value - value) / one.deviation)
    assert found.prediction is not None
    gain = found.prediction.improvement
    return _Found(errors["well"], errors["weakly"], distances, len(errors["no"]), gain, seconds)


def measure() -> dict[str, float]:
    """The worst of several crafts, and the medians of their numbers."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = list(pool.map(_identify, range(1, _CRAFTS + 1)))
    well = [error for run in runs for error in run.errors]
    weak = [error for run in runs for error in run.weak]
    distances = [one for run in runs for one in run.distances]
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
