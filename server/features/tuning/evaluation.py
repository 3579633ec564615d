"""The evaluation of an ended run."""

from collections.abc import Mapping
from typing import Any

from server.features.tuning.curve import SampleBuffer, TuningCurve
from server.features.tuning.figures import measure_response
from server.features.tuning.relay import TIME_TOLERANCE, measure_limit_cycle
from server.features.tuning.schemas import RelayStart, RunState, StepStart

LEAD = 3.0
"""s of a curve before the step."""


def measure_run(
    experiment: StepStart | RelayStart,
    samples: SampleBuffer,
    starts: Mapping[str, float],
    state: RunState,
    problem: str,
) -> tuple[dict[str, Any], TuningCurve, str]:
    """Return the results, the curve, and the reason for missing results.

    `starts` are the starts of the phases (s, steady clock). Only a complete run is evaluated.
    """
    began, ended = min(starts.values(), default=0.0), starts.get(state, float("inf"))
    if experiment.kind == "relay":
        return _relay(experiment, samples, starts, began, ended, state, problem)
    step = starts.get("running", began)
    curve = samples.curve.between(max(began, step - LEAD), ended, step)
    if state != "complete":
        return {}, curve, problem
    figures = measure_response(curve, samples, experiment.loop, step, ended)
    if not figures:
        return {}, curve, "No ticks of the loop came during the run."
    return {"figures": {name: figure.model_dump() for name, figure in figures.items()}}, curve, problem


def _relay(
    experiment: RelayStart,
    samples: SampleBuffer,
    starts: Mapping[str, float],
    began: float,
    ended: float,
    state: RunState,
    problem: str,
) -> tuple[dict[str, Any], TuningCurve, str]:
    # The relay ends one tick before the set point returns to its previous value.
    curve = samples.curve.between(began, ended + TIME_TOLERANCE, began)
    if state != "complete" or "running" not in starts:
        return {}, curve, problem
    try:
        cycle = measure_limit_cycle(curve, starts["running"] - began, experiment.hysteresis)
    except ValueError as why:
        return {}, curve, f"Nothing could be measured: {why}."
    return {"cycle": cycle.model_dump()}, curve, ""
