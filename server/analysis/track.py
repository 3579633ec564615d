"""The track of a dive: dead reckoning as the robot computed it, and the true one where it was simulated.

Each arming begins a track of its own at 0, 0. The true one is laid so that both begin at the same place.
"""

from collections.abc import Mapping

import numpy as np

from server.analysis.figures import MEASURED
from server.analysis.moments import Span
from server.analysis.story_schemas import SwumTrack, Way
from server.metrics.series import Floats, Series

ESTIMATE = ("track.x", "track.y", "track.deviation_x", "track.deviation_y")
TRUE = ("truth.position_0", "truth.position_1", "truth.position_2")
TRACKS_MAX = 20
"""Tracks in one answer, the first ones of a session."""
POINTS_MAX = 600
"""Points of all tracks together, and as many of the true ones."""


def find_tracks(series: Mapping[str, Series], armed: tuple[Span, ...]) -> list[SwumTrack]:
    """Return the tracks of the armed spans, by the signals ESTIMATE, TRUE and MEASURED that exist."""
    if any(name not in series for name in ESTIMATE):
        return []
    spans = armed[:TRACKS_MAX]
    points = POINTS_MAX // max(len(spans), 1)
    tracks = (_find_track(series, span, points) for span in spans)
    return [track for track in tracks if track is not None]


def _find_track(series: Mapping[str, Series], span: Span, points: int) -> SwumTrack | None:
    inside = series[ESTIMATE[0]].within(span.start, span.end).times
    if not inside.size:
        return None
    # The end always: the deviation is there.
    times = inside[np.unique(np.linspace(0, inside.size - 1, points).astype(int))]
    x, y, across, along = (_at(series[name], times) for name in ESTIMATE)
    depth = _at(series[MEASURED], times) if MEASURED in series else np.zeros(times.size)
    truth: Way | None = None
    if all(name in series for name in TRUE):
        north, east, down = (_at(series[name], times) for name in TRUE)
        truth = _way(times, north - north[0] + x[0], east - east[0] + y[0], down)
    return SwumTrack(
        estimate=_way(times, x, y, depth), deviation=(float(across[-1]), float(along[-1])), truth=truth
    )


def _at(series: Series, times: Floats) -> Floats:
    return np.interp(times, series.times, series.values)


def _way(times: Floats, x: Floats, y: Floats, depth: Floats) -> Way:
    return Way(
        time=np.round(times, 2).tolist(),
        x=np.round(x, 3).tolist(),
        y=np.round(y, 3).tolist(),
        depth=np.round(depth, 3).tolist(),
    )
