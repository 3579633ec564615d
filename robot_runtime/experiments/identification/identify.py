"""Identifies a craft from recorded sessions, and checks it on a session that was left out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot
from typing import Literal

import numpy as np

from robot_runtime.contract.craft import Craft, Vector
from robot_runtime.experiments.identification.bodies import CHANNELS, Floats
from robot_runtime.experiments.identification.fit import Fit, FitSolution, Progress
from robot_runtime.experiments.identification.prediction import KNOWN_MOMENTS, predict
from robot_runtime.experiments.identification.quantities import CraftQuantity
from robot_runtime.experiments.identification.streams import (
    AGE_DEVIATION,
    EVERY,
    STEP,
    SessionStreams,
    Windows,
    cut,
    sensor_noise,
)

CHANNEL_NAMES: tuple[tuple[str, str], ...] = (
    ("depth", "m"),
    ("roll rate", "rad/s"),
    ("pitch rate", "rad/s"),
    ("yaw rate", "rad/s"),
    ("force forward", "m/s²"),
    ("force right", "m/s²"),
    ("force down", "m/s²"),
)
WEAK = 0.025
"""Relative standard deviation above which a number is weakly seen: two of them are 5 %."""

Seen = Literal["well", "weakly", "no"]


@dataclass(frozen=True, slots=True)
class QuantityResult:
    """A number of the craft before and after the fit; `deviation` is its standard deviation."""

    quantity: CraftQuantity
    before: float
    value: float
    deviation: float | None
    """None: these sessions do not show it."""
    seen: Seen


@dataclass(frozen=True, slots=True)
class Prediction:
    """Predictions of a session that the fit has not seen, by the craft before the fit and the fitted one.

    A window's first 2 s give its start, the rest is predicted. Errors are roots of mean squares.
    """

    session: str
    times: Floats
    """s of the session, of shape (windows, moments)."""
    measured: Floats
    """Of shape (windows, CHANNELS, moments)."""
    before: Floats
    after: Floats
    before_rms: Floats
    """Of each channel."""
    after_rms: Floats
    before_error: float
    """Root of the mean, over the channels, of squared errors over the measured signal's own variance."""
    after_error: float

    @property
    def improvement(self) -> float:
        """The error before over the error after."""
        return self.before_error / self.after_error


@dataclass(frozen=True, slots=True)
class Identification:
    """The result: the craft, each number with its confidence, and the check."""

    craft: Craft
    results: tuple[QuantityResult, ...]
    noise: dict[str, float]
    """σ by sensor: Pa, rad/s, m/s²."""
    offsets: Floats
    """Of each session's IMU, of shape (sessions, 6), in rad/s and m/s²; nan for one without a window."""
    windows: tuple[int, ...]
    """Number of windows of each session."""
    prediction: Prediction | None


def identify(
    sessions: Sequence[SessionStreams],
    left_out: SessionStreams | None,
    start: Craft,
    progress: Progress = lambda _share: None,
) -> Identification:
    """Fit `start` to the sessions. Raise ValueError with the reason where none of them can be used."""
    windows = cut(sessions, start)
    # Cut first: a check that is not possible is told before minutes of computing.
    check = None if left_out is None else cut([left_out], start)
    solution = Fit(windows, start, lambda share: progress(0.9 * share)).run()
    counts = tuple(windows.sessions.count(index) for index in range(len(sessions)))
    noise = _mean_noise(sessions)
    offsets = np.full((len(sessions), solution.offsets.shape[1]), np.nan)
    for index in range(len(solution.offsets)):
        if counts[index]:
            offsets[index] = solution.offsets[index]
    craft = _with_sensors(solution.craft, noise, np.nanmean(offsets, axis=0))
    prediction = None
    if check is not None and left_out is not None:
        prediction = _check(left_out.name, check, start, craft)
    progress(1.0)
    return Identification(
        craft=craft,
        results=_list_results(solution, start),
        noise=noise,
        offsets=offsets,
        windows=counts,
        prediction=prediction,
    )


def _list_results(solution: FitSolution, start: Craft) -> tuple[QuantityResult, ...]:
    results = []
    for quantity, scaled in zip(solution.fitted, solution.deviations.tolist(), strict=True):
        value = quantity.value(solution.craft)
        deviation = quantity.deviation(scaled, value)
        if quantity.entry == "fin_delay":
            # It counts from the readings' ages, which no motion shows.
            deviation = hypot(deviation, AGE_DEVIATION)
        weak = deviation > WEAK * abs(value) if not quantity.spread else scaled > WEAK * 2
        seen: Seen = "weakly" if weak else "well"
        results.append(QuantityResult(quantity, quantity.value(start), value, deviation, seen))
    for quantity in solution.unseen:
        value = quantity.value(start)
        results.append(QuantityResult(quantity, value, value, None, "no"))
    return tuple(results)


def _mean_noise(sessions: Sequence[SessionStreams]) -> dict[str, float]:
    each = [sensor_noise(session) for session in sessions]
    names = dict.fromkeys(name for noise in each for name in noise)
    return {name: float(np.mean([noise[name] for noise in each if name in noise])) for name in names}


def _with_sensors(craft: Craft, noise: dict[str, float], offset: Floats) -> Craft:
    """Return the craft with this noise of its sensors, and this offset of its IMU."""
    p, q, r, x, y, z = offset.tolist()
    rate: Vector = (p, q, r)
    force: Vector = (x, y, z)
    sensors = {name: replace(getattr(craft, name), noise=sigma) for name, sigma in noise.items()}
    return replace(craft, gyroscope_offset=rate, accelerometer_offset=force, **sensors)


def _check(name: str, windows: Windows, start: Craft, craft: Craft) -> Prediction:
    before, after = predict(windows, start), predict(windows, craft)
    measured = windows.measured.transpose(2, 0, 1)
    # Of the depth, what the hull does within a window.
    moved = measured - measured[:, :, KNOWN_MOMENTS : KNOWN_MOMENTS + 1]
    variance = np.concatenate(
        ((moved[:, :1, KNOWN_MOMENTS:] ** 2).mean(axis=(0, 2)), measured[:, 1:].var(axis=(0, 2)))
    )
    assert len(variance) == CHANNELS

    def error(rms: Floats) -> float:
        return float(np.sqrt(np.mean(rms**2 / variance)))

    grid = np.arange(measured.shape[2]) * STEP * EVERY
    return Prediction(
        session=name,
        times=np.array(windows.starts)[:, None] + grid,
        measured=measured,
        before=before.channels,
        after=after.channels,
        before_rms=before.rms,
        after_rms=after.rms,
        before_error=error(before.rms),
        after_error=error(after.rms),
    )
