"""The limit cycle of a relay experiment."""

from itertools import pairwise

import numpy as np

from server.features.tuning.curve import TuningCurve
from server.features.tuning.rules import ultimate_gain
from server.features.tuning.schemas import MeasuredLimitCycle
from server.metrics.series import Floats

TIME_TOLERANCE = 0.05
"""s between the times of a tick and its effect; less than the time between two ticks."""
SPREAD_MAX = 0.2
"""Largest relative spread of the cycles, and of their halves, without a remark."""


def measure_limit_cycle(curve: TuningCurve, began: float, hysteresis: float) -> MeasuredLimitCycle:
    """Return period, swing and ultimate gain over the cycles from `began` (s of the curve) on.

    Each is the median over whole cycles, from one switch of the relay to its greater command to the next.
    Raise ValueError without a whole cycle, or if the swing does not exceed the hysteresis.
    """
    times, values, outputs = (np.array(column) for column in (curve.times, curve.values, curve.outputs))
    counts = outputs[times >= began - TIME_TOLERANCE]
    bias = float(counts.max() + counts.min()) / 2 if counts.size else 0.0
    greater = outputs > bias
    turns = np.flatnonzero(greater[1:] & ~greater[:-1]) + 1
    turns = turns[times[turns] >= began - TIME_TOLERANCE]
    if turns.size < 2:
        raise ValueError("there is no whole cycle")
    cycles = [slice(first, last) for first, last in pairwise(turns)]
    periods = np.diff(times[turns])
    swings = np.array([np.ptp(values[cycle]) / 2 for cycle in cycles])
    halves = np.array([2 * float(greater[cycle].mean()) - 1 for cycle in cycles])
    period, swing = float(np.median(periods)), float(np.median(swings))
    amplitude = float(counts.max() - counts.min()) / 2
    asymmetry = float(np.median(halves))
    return MeasuredLimitCycle(
        cycles=len(cycles),
        period=period,
        swing=swing,
        amplitude=amplitude,
        bias=bias,
        asymmetry=asymmetry,
        ultimate_gain=ultimate_gain(amplitude, swing, hysteresis),
        remarks=_remarks(periods, swings, asymmetry),
    )


def _remarks(periods: Floats, swings: Floats, asymmetry: float) -> list[str]:
    remarks = []
    if any(np.ptp(series) > SPREAD_MAX * np.median(series) for series in (periods, swings)):
        remarks.append(
            "The cycles differ by more than 20 %: the water moves, or there are too few of them. "
            "Run it again."
        )
    if abs(asymmetry) > SPREAD_MAX:
        remarks.append(
            "One half of each cycle is much longer than the other, since the load is more than the bias can "
            "balance: the ultimate gain is too low then. Trim the robot, or choose a smaller amplitude."
        )
    return remarks
