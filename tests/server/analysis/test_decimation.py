from math import pi

import numpy as np
import pytest

from server.analysis.decimation import Envelope, decimate
from server.metrics.series import Series


def test_few_samples_pass_unchanged() -> None:
    series = Series(np.array([0.0, 0.5, 1.0]), np.array([3.0, 1.0, 2.0]))
    drawn = decimate(series, 0.0, 1.0, 10)
    assert drawn.time.tolist() == [0.0, 0.5, 1.0]
    assert drawn.low.tolist() == drawn.high.tolist() == [3.0, 1.0, 2.0]


@pytest.mark.parametrize("at", [0, 1, 77_777, 179_998, 179_999])
def test_no_spike_is_lost(at: int) -> None:
    times = np.arange(180_000) / 50
    values = np.sin(times)
    values[at] = 9.0
    drawn = decimate(Series(times, values), 0.0, 3600.0, 500)
    assert 500 <= drawn.time.size <= 502
    column = int(np.flatnonzero(drawn.high == 9.0)[0])
    assert drawn.time[column] <= times[at]
    assert column == drawn.time.size - 1 or times[at] < drawn.time[column + 1]
    assert drawn.low.min() == values.min()


def test_a_part_has_finer_samples_and_its_neighbours() -> None:
    times = np.arange(180_000) / 50
    drawn = decimate(Series(times, times.copy()), 100.0, 101.0, 500)
    assert drawn.time.tolist() == [index / 50 for index in range(4999, 5052)]
    assert drawn.low.tolist() == drawn.high.tolist() == drawn.time.tolist()


@pytest.mark.parametrize("points", [50, 10_000])
def test_a_pause_breaks_the_line(points: int) -> None:
    times = np.concatenate([np.arange(0, 100, 0.02), np.arange(160, 200, 0.02)])
    drawn = decimate(Series(times, np.ones(times.size)), 0.0, 200.0, points)
    (broken,) = np.flatnonzero(np.isnan(drawn.low))
    assert drawn.time[broken - 1] < 100 < drawn.time[broken] < 160 <= drawn.time[broken + 1] + 4
    assert np.flatnonzero(np.isnan(drawn.high)).tolist() == [broken]


def test_slow_signals_are_not_broken() -> None:
    times = np.arange(0, 600, 1.0)
    assert not np.isnan(decimate(Series(times, times), 0.0, 600.0, 5000).low).any()


def test_no_samples_give_no_points() -> None:
    empty = np.empty(0)
    assert decimate(Series(empty, empty), 0.0, 10.0, 100).time.size == 0


def test_nan_does_not_hide_other_samples() -> None:
    times = np.arange(1000) / 50
    values = np.ones(1000)
    values[::3] = np.nan
    drawn = decimate(Series(times, values), 0.0, 20.0, 20)
    assert drawn.low.tolist() == drawn.high.tolist() == [1.0] * drawn.time.size


def longest_way(drawn: Envelope) -> float:
    """Return the longest way up or down of the line through each column's minimum and maximum."""
    line = np.stack([drawn.low, drawn.high], axis=1).ravel()
    return float(np.nanmax(np.abs(np.diff(line))))


@pytest.mark.parametrize("points", [60, 10_000])
@pytest.mark.parametrize("way", [1, -1])
def test_an_angle_breaks_where_it_wraps(points: int, way: int) -> None:
    times = np.arange(0, 100, 0.02)
    turning = way * (2.0 + 0.05 * times)
    angles = np.arctan2(np.sin(turning), np.cos(turning))
    drawn = decimate(Series(times, angles), 0.0, 100.0, points, angle=True)
    assert longest_way(drawn) < 0.3
    assert np.isnan(drawn.low).sum() == np.isnan(drawn.high).sum() == 1
    assert (np.nanmin(drawn.low), np.nanmax(drawn.high)) == (angles.min(), angles.max())
    other = decimate(Series(times, angles), 0.0, 100.0, points)
    assert longest_way(other) > 6


def test_an_angle_that_trembles_about_the_wrap_stays_at_the_edges() -> None:
    times = np.arange(0, 100, 0.02)
    turning = pi + 0.1 * np.sin(50 * times)
    angles = np.arctan2(np.sin(turning), np.cos(turning))
    angles[::7] = np.nan
    drawn = decimate(Series(times, angles), 0.0, 100.0, 50, angle=True)
    assert longest_way(drawn) < 0.2
    assert np.diff(drawn.time).min() >= 0
    assert drawn.time.size <= 4 * 52
    assert min(np.nanmin(np.abs(drawn.low)), np.nanmin(np.abs(drawn.high))) > pi - 0.11
