"""The result of a fit for the page, the report and the craft file."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from datetime import UTC, datetime
from math import isfinite, log10
from typing import Any

import numpy as np
import tomli_w

from robot_runtime.contract.craft import TITLE_MAX, Craft, SensorQuality, craft_table
from robot_runtime.experiments.identification.identify import (
    CHANNEL_NAMES,
    Identification,
    Prediction,
    QuantityResult,
)
from server.features.identification.effect import describe_effect
from server.features.identification.schemas import (
    CheckedSession,
    FittedSession,
    IdentificationResult,
    IdentifiedNumber,
    PredictedChannel,
    describe_improvement,
)
from server.metrics.series import Floats

DIGITS = 5
"""Significant digits of a number in a craft file: more than any fit knows."""
SHOWN_WINDOWS = 6
"""Of the session that was left out, in charts."""
SHOWN_EVERY = 2
"""Moments of 20 ms between two that charts show."""
BREAK = 0.005
"""s after a window's last moment at which its lines break."""


def describe(
    identification: Identification, sessions: Mapping[int, str], left_out: int | None, start: Craft
) -> IdentificationResult:
    """Return the result of a fit of `start` to the sessions, given with their names."""
    craft = _rounded(identification.craft, start)
    return IdentificationResult(
        sessions=[
            FittedSession(id=number, name=name, windows=windows, offsets=_numbers(offsets))
            for (number, name), windows, offsets in zip(
                sessions.items(), identification.windows, identification.offsets, strict=True
            )
        ],
        numbers=[_describe_number(result) for result in identification.results],
        noise={name: _significant(sigma, 3) for name, sigma in identification.noise.items()},
        check=None
        if identification.prediction is None
        else _describe_check(identification.prediction, left_out or 0),
        missing=_missing(identification.results),
        affected=describe_effect(start, craft),
        craft=write_craft(craft, list(sessions.values()), identification.prediction),
    )


def write_craft(craft: Craft, names: Sequence[str], check: Prediction | None) -> str:
    """Return the craft file."""
    day = f"{datetime.now(UTC):%Y-%m-%d}"
    origin = f"Fitted to {', '.join(names)} on {day}."
    if check is not None:
        origin += f" {check.session} is predicted {describe_improvement(check.improvement)} than before."
    title = f"Fitted to {', '.join(names)}"
    document = {"title": title[:TITLE_MAX], "origin": origin[:2000], "craft": craft_table(craft)}
    return tomli_w.dumps(document)


def _describe_number(result: QuantityResult) -> IdentifiedNumber:
    quantity = result.quantity
    if result.deviation is None:
        text = f"not seen in these sessions: it needs {quantity.motion}"
    else:
        text = f"± {_significant(result.deviation, 2):g} {quantity.unit}".rstrip()
        if result.seen == "weakly":
            text += "; weakly seen"
    return IdentifiedNumber(
        name=quantity.name,
        title=quantity.title,
        unit=quantity.unit,
        before=_significant(result.before, DIGITS),
        value=_significant(result.value, DIGITS),
        deviation=result.deviation,
        seen=result.seen,
        words=text,
    )


def _missing(results: Sequence[QuantityResult]) -> list[str]:
    """Return the missing motions, each with the numbers that stay unknown without it."""
    motions: dict[str, list[str]] = {}
    for result in results:
        if result.seen == "no":
            title = result.quantity.title
            motions.setdefault(result.quantity.motion, []).append(title[0].lower() + title[1:])
    return [f"{motion[0].upper()}{motion[1:]}: {', '.join(names)}" for motion, names in motions.items()]


def _describe_check(check: Prediction, session: int) -> CheckedSession:
    times: list[float] = []
    for row in check.times[:SHOWN_WINDOWS]:
        shown = [round(float(value), 3) for value in row[::SHOWN_EVERY]]
        times += [*shown, round(shown[-1] + BREAK, 3)]
    return CheckedSession(
        id=session,
        name=check.session,
        before_error=_significant(check.before_error, 3),
        after_error=_significant(check.after_error, 3),
        improvement=_significant(check.improvement, 3),
        times=times,
        channels=[
            PredictedChannel(
                name=name,
                unit=unit,
                before_rms=_significant(float(check.before_rms[index]), 3),
                after_rms=_significant(float(check.after_rms[index]), 3),
                measured=_line(check.measured[:, index]),
                before=_line(check.before[:, index]),
                after=_line(check.after[:, index]),
            )
            for index, (name, unit) in enumerate(CHANNEL_NAMES)
        ],
    )


def _line(windows: Floats) -> list[float | None]:
    """Return the windows one after the other, with a break after each."""
    line: list[float | None] = []
    for row in windows[:SHOWN_WINDOWS]:
        line += [_significant(float(value), 4) for value in row[::SHOWN_EVERY]] + [None]
    return line


def _numbers(values: Floats) -> list[float] | None:
    return None if np.isnan(values).any() else [_significant(value, 3) for value in values.tolist()]


def _rounded(craft: Craft, start: Craft) -> Craft:
    """Return the craft, with numbers that differ from `start` to the digits of a file."""
    pairs = {field.name: (getattr(craft, field.name), getattr(start, field.name)) for field in fields(Craft)}
    return replace(craft, **{name: _round(new, old) for name, (new, old) in pairs.items()})


def _round(new: Any, old: Any) -> Any:
    if new == old:
        return old
    if isinstance(new, tuple):
        return tuple(_round(value, before) for value, before in zip(new, old, strict=True))
    if isinstance(new, SensorQuality):
        return replace(new, noise=_significant(new.noise, DIGITS))
    return _significant(new, DIGITS)


def _significant(value: float, digits: int) -> float:
    if value == 0 or not isfinite(value):
        return value
    return round(value, digits - 1 - int(np.floor(log10(abs(value)))))
