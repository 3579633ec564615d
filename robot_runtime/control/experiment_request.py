"""Reads what an experiment is to be from a command, and refuses what cannot be."""

import math
from collections.abc import Mapping
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.limits import Range
from robot_runtime.control.experiment import (
    LoopExperiment,
    RelayExperiment,
    RelaySettings,
    StepExperiment,
    StepSettings,
)
from robot_runtime.control.loop import ControlLoop
from robot_runtime.errors import RefusedError

SETTLE, DURATION = Range(0, 120), Range(2, 300)
"""s."""
AMPLITUDE, CYCLES = Range(0.1, 1.0), Range(3, 20)
HYSTERESIS_SHARE = 0.25
"""Of the way between the limits: what the relay may wait beyond the set point at most."""


def read_experiment(
    question: Mapping[str, Any], loops: Mapping[str, ControlLoop], clock: Clock
) -> tuple[int, ControlLoop, LoopExperiment]:
    """Its number, its loop, and itself. Raises RefusedError with what is wrong."""
    number, name, kind = question.get("number"), question.get("loop"), question.get("kind")
    if type(number) is not int:
        raise RefusedError(f"number is {number!r}; it must be a whole number")
    loop = loops.get(str(name))
    if loop is None:
        raise RefusedError(f"there is no loop {name!r}; there are {', '.join(loops)}")
    make = {"step": _step, "relay": _relay}.get(str(kind))
    if make is None:
        raise RefusedError(f"there is no experiment {kind!r}; there are step and relay")
    return number, loop, make(question, loop.limits, clock)


def _step(question: Mapping[str, Any], loop: Range, clock: Clock) -> LoopExperiment:
    low, high = _limits(question)
    settings = StepSettings(
        start=_between(question, "start", loop),
        target=_between(question, "target", loop),
        tolerance=_between(question, "tolerance", Range(0, high - low)),
        settle=_between(question, "settle", SETTLE),
        duration=_between(question, "duration", DURATION),
        low=low,
        high=high,
    )
    if settings.start == settings.target:
        raise RefusedError("start and target are the same; a step leads from one to the other")
    _require_within("start", settings.start, low, high)
    _require_within("target", settings.target, low, high)
    return StepExperiment(settings, clock)


def _relay(question: Mapping[str, Any], loop: Range, clock: Clock) -> LoopExperiment:
    low, high = _limits(question)
    cycles = _between(question, "cycles", CYCLES)
    if cycles != round(cycles):
        raise RefusedError(f"cycles is {cycles:g}; it must be a whole number")
    settings = RelaySettings(
        set_point=_between(question, "set_point", loop),
        amplitude=_between(question, "amplitude", AMPLITUDE),
        hysteresis=_between(question, "hysteresis", Range(0, HYSTERESIS_SHARE * (high - low))),
        cycles=round(cycles),
        duration=_between(question, "duration", DURATION),
        low=low,
        high=high,
    )
    _require_within("set_point", settings.set_point, low, high)
    return RelayExperiment(settings, clock)


def _limits(question: Mapping[str, Any]) -> tuple[float, float]:
    low, high = _number(question, "low"), _number(question, "high")
    if low >= high:
        raise RefusedError(f"low is {low:g} and high {high:g}; the limits must be apart")
    return low, high


def _require_within(name: str, value: float, low: float, high: float) -> None:
    if not low < value < high:
        raise RefusedError(f"{name} is {value:g}; it must lie between the limits {low:g} and {high:g}")


def _between(question: Mapping[str, Any], name: str, limits: Range) -> float:
    value = _number(question, name)
    if not limits.minimum <= value <= limits.maximum:
        raise RefusedError(
            f"{name} is {value:g}; it must lie between {limits.minimum:g} and {limits.maximum:g}"
        )
    return value


def _number(question: Mapping[str, Any], name: str) -> float:
    value = question.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RefusedError(f"{name} is {value!r}; it must be a number")
    return float(value)
