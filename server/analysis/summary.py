"""The summary of a session for the list."""

from collections.abc import Callable, Iterable
from itertools import islice
from math import floor, isfinite
from typing import Any, TypeVar

import numpy as np

from robot_runtime.contract.topics import DETECTION, FILM, MISSION, STATE, THUMBNAIL
from server.analysis.figures import MEASURED
from server.analysis.segments import find_segments
from server.analysis.session_reader import SessionReader
from server.library.content import Recording, RecordingError, reading_content
from server.library.timeline import EVENTS_MAX, read_events
from server.metrics.series import Series
from server.recording.schemas import CURVE_POINTS, SessionSummary

T = TypeVar("T")

NAMES_MAX = 8
"""Controllers, modes, and cards of a summary, the first of each."""


class _Reading:
    """The parts of a recording that can be read; `damaged` says whether one could not."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.damaged = False

    def part(self, read: Callable[[], T]) -> T | None:
        """Return what `read` returns, or None where the samples are damaged."""
        try:
            with reading_content(self.recording.row):
                return read()
        except RecordingError:
            self.damaged = True
            return None


def summarise(reader: SessionReader, session: int) -> SessionSummary:
    """Return the summary of a session that has ended; damaged samples are left out.

    Raise UnknownSessionError, StoreError.
    """
    recording = reader.open(session)
    reading = _Reading(recording)
    part = reading.part
    depth = next(iter((part(lambda: reader.samples.read(recording, [MEASURED])) or {}).values()), None)
    history = part(lambda: reader.history(recording))
    # Without the set point, whose samples may be damaged.
    segments = [] if history is None else find_segments(history, None, recording.row.duration)
    states = part(lambda: list(recording.changes(STATE.name)) if _has(recording, STATE.name) else []) or []
    seen = part(lambda: _first_seen(recording, states)) or {}
    events = part(lambda: read_events(recording, EVENTS_MAX)) or []
    deepest = None if depth is None else _deepest(depth)
    moment = next(iter(seen.values()), 0.0 if deepest is None else deepest[0])
    return SessionSummary(
        depth=None if deepest is None else round(deepest[1], 3),
        armed=0.0 if history is None else sum(span.end - max(span.start, 0) for span in history.armed),
        controllers=_names(segment.title or segment.controller for segment in segments),
        modes=_names(segment.mode for segment in segments),
        cards=_names(seen),
        mission=part(lambda: _mission(recording)) or "",
        alarms=sum(event.severity == "alarm" for event in events),
        curve=[] if depth is None else _curve(depth, recording.row.duration),
        face=part(lambda: _face(recording, moment)),
        damaged=reading.damaged,
    )


def _has(recording: Recording, topic: str) -> bool:
    return topic in recording.topics and recording.has(topic)


def _names(names: Iterable[object]) -> list[str]:
    """Return the first different names in their order."""
    return list(islice(dict.fromkeys(str(name) for name in names if name), NAMES_MAX))


def _first_seen(recording: Recording, states: list[dict[str, Any]]) -> dict[str, float]:
    """Return each card with when it was seen first (s since the start), in the order of these times.

    A simulator says which card it shows; of a real camera the detection confirms one.
    """
    shown = [(state["time"], state["card"]) for state in states if state.get("card")]
    if not shown and not any(state.get("cards") for state in states) and _has(recording, DETECTION.name):
        shown = [
            (document["time"], colour)
            for document in recording.documents(DETECTION.name)
            for colour in document.get("confirmed", ())
        ]
    first: dict[str, float] = {}
    for time, card in shown:
        first.setdefault(str(card), time - recording.row.started_steady)
    return first


def _mission(recording: Recording) -> str:
    if not _has(recording, MISSION.name):
        return ""
    return str(
        next((document["title"] or document["name"] for document in recording.documents(MISSION.name)), "")
    )


def _deepest(depth: Series) -> tuple[float, float] | None:
    """Return time (s since the start) and depth (m) of the greatest depth."""
    if not np.isfinite(depth.values).any():
        return None
    at = int(np.nanargmax(np.where(np.isfinite(depth.values), depth.values, np.nan)))
    return float(depth.times[at]), float(depth.values[at])


def _curve(depth: Series, duration: float) -> list[float | None]:
    """Return the greatest depth of each of `CURVE_POINTS` equal parts of the session."""
    parts = np.clip((depth.times / max(duration, 1e-3) * CURVE_POINTS).astype(int), 0, CURVE_POINTS - 1)
    greatest = np.full(CURVE_POINTS, -np.inf)
    np.maximum.at(greatest, parts, np.where(np.isfinite(depth.values), depth.values, -np.inf))
    return [round(float(value), 2) if isfinite(value) else None for value in greatest]


def _face(recording: Recording, moment: float) -> float | None:
    """Return `moment` (s since the start), or the nearest one from which on there is a picture.

    Where there are no small ones, it is of the film.
    """
    spans = recording.spans(THUMBNAIL.name) or recording.spans(FILM.name)
    if not spans:
        return None
    start = recording.row.started_steady
    last = max(end for _, end, _ in spans) - start
    # Rounded down, so that it is not beyond the last one.
    return floor(min(max(moment, 0.0), last) * 1000) / 1000
