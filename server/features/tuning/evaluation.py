"""Results of a run that has ended."""

from collections.abc import Mapping
from typing import Any

from server.features.tuning.curve import Gathering, TuningCurve
from server.features.tuning.figures import measure_response
from server.features.tuning.relay import SAME, find_ultimate
from server.features.tuning.schemas import RelayStart, RunState, StepStart

LEAD = 3.0
"""s before the step that a curve begins."""


def measure_run(
    experiment: StepStart | RelayStart,
    gathering: Gathering,
    starts: Mapping[str, float],
    state: RunState,
    problem: str,
) -> tuple[dict[str, Any], TuningCurve, str]:
    """The results, the curve, and the reason where there are no results.

    `starts` says when each phase began (s, steady clock). Only a run that is complete is measured.
    """
    began, ended = min(starts.values(), default=0.0), starts.get(state, float("inf"))
    if experiment.kind == "relay":
        return _relay(experiment, gathering, starts, began, ended, problem)
    step = starts.get("running", began)
    curve = gathering.curve.between(max(began, step - LEAD), ended, step)
    if state != "complete":
        return {}, curve, problem
    figures = measure_response(curve, gathering, experiment.loop, step, ended)
    if not figures:
        return {}, curve, "No ticks of the loop came during the run."
    return {"figures": {name: figure.model_dump() for name, figure in figures.items()}}, curve, problem


def _relay(
    experiment: RelayStart,
    gathering: Gathering,
    starts: Mapping[str, float],
    began: float,
    ended: float,
    problem: str,
) -> tuple[dict[str, Any], TuningCurve, str]:
    # The relay ends in its last tick, a step before the tick in which the set point is the usual one again.
    curve = gathering.curve.between(began, ended + SAME, began)
    if problem or "running" not in starts:
        return {}, curve, problem
    try:
        cycle = find_ultimate(curve, starts["running"] - began, experiment.hysteresis)
    except ValueError as why:
        return {}, curve, f"Nothing could be measured: {why}."
    return {"cycle": cycle.model_dump()}, curve, ""
