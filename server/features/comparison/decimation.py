"""Decimation of signals for display: minimum and maximum of each pixel column.

A chart of n columns shows the same line whether all samples are drawn or only the minimum and maximum of each
column (Jugel et al., M4: A Visualization-Oriented Time Series Data Aggregation, VLDB 2014). No spike is
lost.
"""

from dataclasses import dataclass

import numpy as np

from server.features.metrics.series import Floats, Series

GAP_PERIODS = 5.0
GAP_LEAST = 1.0
"""s without samples, at least, and number of usual periods, that break the line."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Minimum and maximum of each column, shape (columns,); NaN in both breaks the line."""

    time: Floats
    low: Floats
    high: Floats


def decimate(series: Series, start: float, end: float, points: int) -> Envelope:
    """The samples between these times (s) in at most about `points` columns of equal width.

    Fewer samples are returned unchanged. The neighbours outside the range are included, so that the line
    reaches the chart's edges.
    """
    first = max(int(np.searchsorted(series.times, start, "left")) - 1, 0)
    last = int(np.searchsorted(series.times, end, "right")) + 1
    times, values = series.times[first:last], series.values[first:last]
    pause = _pause(series.times)
    if times.size <= points:
        return _broken(times, values, values, pause)
    width = (end - start) / points
    columns = np.floor((times - start) / width)
    firsts = np.flatnonzero(np.concatenate([[True], columns[1:] != columns[:-1]]))
    low, high = np.fmin.reduceat(values, firsts), np.fmax.reduceat(values, firsts)
    return _broken(times[firsts], low, high, max(pause, 2 * width))


def _pause(times: Floats) -> float:
    usual = float(np.median(np.diff(times))) if times.size > 1 else 0.0
    return max(GAP_PERIODS * usual, GAP_LEAST)


def _broken(times: Floats, low: Floats, high: Floats, pause: float) -> Envelope:
    """The envelope with NaN in pauses longer than `pause` (s)."""
    after = np.flatnonzero(np.diff(times) > pause)
    if not after.size:
        return Envelope(times, low, high)
    middles = (times[after] + times[after + 1]) / 2
    broken = (np.insert(one, after + 1, np.nan) for one in (low, high))
    return Envelope(np.insert(times, after + 1, middles), *broken)
