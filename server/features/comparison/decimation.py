"""Fewer points that look the same: the least and the most of each column of the picture.

A picture that is n columns wide shows the same line whether all samples are drawn or, in each column, its
least and its most (Jugel et al., M4: A Visualization-Oriented Time Series Data Aggregation, VLDB 2014). No
spike is lost that way.
"""

from dataclasses import dataclass

import numpy as np

from server.features.metrics.series import Floats, Series

GAP_PERIODS = 5.0
GAP_LEAST = 1.0
"""s without samples, at least, and so many usual periods: then the line is broken."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Least and most of each column, shape (columns,); NaN in both breaks the line."""

    time: Floats
    low: Floats
    high: Floats


def decimate(series: Series, start: float, end: float, points: int) -> Envelope:
    """The samples between these times (s) in at most about `points` columns of equal width.

    Fewer samples than that are passed on as they are. Neighbours outside the range come along, so that the
    line runs to the picture's edges.
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
    """With NaN where nothing came for longer than `pause` (s)."""
    after = np.flatnonzero(np.diff(times) > pause)
    if not after.size:
        return Envelope(times, low, high)
    middles = (times[after] + times[after + 1]) / 2
    broken = (np.insert(one, after + 1, np.nan) for one in (low, high))
    return Envelope(np.insert(times, after + 1, middles), *broken)
