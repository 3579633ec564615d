"""Decimation of signals for display: minimum and maximum of each pixel column.

A chart of n columns shows the same line whether all samples are drawn or only the minimum and maximum of each
column (Jugel et al., M4: A Visualization-Oriented Time Series Data Aggregation, VLDB 2014). No spike is
lost. An angle that goes on at -π after π has a break there instead of a line from one to the other.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from server.metrics.series import Floats, Series

GAP_PERIODS = 5.0
GAP_LEAST = 1.0
"""s without samples, at least, and number of usual periods, that break the line."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Minimum and maximum of each column, shape (columns,); NaN in both breaks the line."""

    time: Floats
    low: Floats
    high: Floats


def decimate(series: Series, start: float, end: float, points: int, *, angle: bool = False) -> Envelope:
    """Return the samples between these times (s) in at most about `points` columns of equal width.

    Fewer samples are returned unchanged. The neighbours outside the range are included, so that the line
    reaches the chart's edges. A column in which an `angle` wraps is two: the angles below 0, and the others.
    """
    first = max(int(np.searchsorted(series.times, start, "left")) - 1, 0)
    last = int(np.searchsorted(series.times, end, "right")) + 1
    times, values = series.times[first:last], series.values[first:last]
    pause = usual_pause(series.times)
    if times.size <= points:
        return _broken(Envelope(times, values, values), pause, angle)
    width = (end - start) / points
    columns = np.floor((times - start) / width)
    firsts = np.flatnonzero(np.concatenate([[True], columns[1:] != columns[:-1]]))
    low, high = np.fmin.reduceat(values, firsts), np.fmax.reduceat(values, firsts)
    line = Envelope(times[firsts], low, high)
    if angle:
        line = _split(line, values, columns, firsts)
    return _broken(line, max(pause, 2 * width), angle)


def usual_pause(times: Floats) -> float:
    """Return the least time without samples (s) that is a pause."""
    usual = float(np.median(np.diff(times))) if times.size > 1 else 0.0
    return max(GAP_PERIODS * usual, GAP_LEAST)


def _split(line: Envelope, values: Floats, columns: Floats, firsts: NDArray[np.intp]) -> Envelope:
    """Return the envelope with two columns for each in which the angle wraps, first the side that goes on."""
    wraps = np.flatnonzero((np.abs(np.diff(values)) > pi) & (columns[1:] == columns[:-1]))
    if not wraps.size:
        return line
    wrapped = set((np.searchsorted(firsts, wraps, "right") - 1).tolist())
    parts = np.split(values, firsts[1:])
    rows: list[tuple[float, float, float]] = []
    for at, row in enumerate(zip(line.time, line.low, line.high, strict=True)):
        if at not in wrapped:
            rows.append(row)
            continue
        sides = [parts[at][parts[at] < 0], parts[at][parts[at] >= 0]]
        if rows and rows[-1][1] >= 0:
            sides.reverse()
        rows += [(row[0], float(side.min()), float(side.max())) for side in sides if side.size]
    return Envelope(*np.array(rows).T)


def _broken(line: Envelope, pause: float, angle: bool) -> Envelope:
    """Return the envelope with NaN in pauses longer than `pause` (s), and where an angle wraps."""
    time, low, high = line.time, line.low, line.high
    breaks = np.diff(time) > pause
    if angle:
        breaks |= np.maximum(low[1:] - high[:-1], low[:-1] - high[1:]) > pi
    after = np.flatnonzero(breaks)
    if not after.size:
        return line
    middles = (time[after] + time[after + 1]) / 2
    broken = (np.insert(bound, after + 1, np.nan) for bound in (low, high))
    return Envelope(np.insert(time, after + 1, middles), *broken)
