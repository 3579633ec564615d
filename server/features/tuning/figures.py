"""The figures of a step response, defined as those of sessions (server/features/comparison)."""

from math import degrees

import numpy as np

from server.features.tuning.curve import SampleBuffer, TuningCurve
from server.features.tuning.figure_definitions import is_angle, near
from server.metrics.figure import Figure, FigureMark
from server.metrics.series import Floats, Series, effort, integral_absolute, rms, travel
from server.metrics.step_response import StepResponse, measure_step
from server.metrics.strokes import count_strokes

STEADY = 0.5
"""Share of the time after the step, at its end, in which the value should be steady."""


def measure_response(
    curve: TuningCurve, samples: SampleBuffer, loop: str, began: float, ended: float
) -> dict[str, Figure]:
    """Return the figures of a step at 0 s of the curve; fin strokes count from `began` to `ended` (s)."""
    series, set_points, outputs = _after_step(curve, loop)
    if series.times.size < 2:
        return {}
    final, end = float(set_points[-1]), float(series.times[-1])
    whole = Series(np.array(curve.times), _in_shown_unit(curve.values, loop))
    share = measure_step(whole, 0.0, end, final)
    close = measure_step(whole, 0.0, end, final, near(loop))
    errors = set_points - series.values
    steady = series.times >= STEADY * end
    return {
        **_step_figures(share, close),
        "steady_error": Figure(value=float(errors[steady].mean())),
        "steady_swing": Figure(value=float(np.ptp(series.values[steady]))),
        "rmse": Figure(value=rms(errors)),
        "iae": Figure(value=integral_absolute(series.times, errors)),
        "effort": Figure(value=100 * effort(outputs)),
        "travel": Figure(value=travel(outputs)),
        "fin_strokes": _strokes(samples, began, ended),
    }


def _after_step(curve: TuningCurve, loop: str) -> tuple[Series, Floats, Floats]:
    times = np.array(curve.times)
    after = times >= 0
    values, set_points = _in_shown_unit(curve.values, loop), _in_shown_unit(curve.set_points, loop)
    return Series(times[after], values[after]), set_points[after], np.array(curve.outputs)[after]


def _in_shown_unit(values: list[float], loop: str) -> Floats:
    return np.array([degrees(value) for value in values] if is_angle(loop) else values)


def _step_figures(share: StepResponse | None, near: StepResponse | None) -> dict[str, Figure]:
    if share is None or near is None:
        none = Figure(value=None, words="The value was at the set point before the step.")
        return dict.fromkeys(("rise_time", "overshoot", "settling_share", "settling_near"), none)
    rise = Figure(
        value=share.rise_time,
        words="" if share.rise_time is not None else "The value never came to 90 % of the step.",
    )
    if share.rise_start is not None and share.rise_end is not None:
        height = share.final_value - share.start_value
        low, high = sorted(share.start_value + part * height for part in (0.1, 0.9))
        rise.mark = FigureMark(start=share.rise_start, end=share.rise_end, low=low, high=high)
    overshoot = Figure(value=100 * share.overshoot)
    if share.peak is not None and share.peak_time is not None:
        low, high = sorted((share.final_value, share.peak))
        overshoot.mark = FigureMark(start=share.begin, end=share.peak_time, low=low, high=high)
    return {
        "rise_time": rise,
        "overshoot": overshoot,
        "settling_share": _settling(share),
        "settling_near": _settling(near),
    }


def _settling(response: StepResponse) -> Figure:
    final, band = response.final_value, response.band
    return Figure(
        value=response.settling_time,
        words="" if response.settled is not None else "The value did not stay in the band until the end.",
        mark=FigureMark(
            start=response.begin,
            end=response.end if response.settled is None else response.settled,
            low=final - band,
            high=final + band,
        ),
    )


def _strokes(samples: SampleBuffer, began: float, ended: float) -> Figure:
    times = np.array(samples.fin_times)
    inside = (times >= began) & (times <= ended)
    if not inside.any():
        return Figure(value=None, words="No fin angles came during the run.")
    return Figure(value=sum(count_strokes(np.array(angle)[inside]) for angle in samples.fins))
