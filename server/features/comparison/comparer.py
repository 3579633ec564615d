"""Compares sessions on one time axis."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import isfinite

import numpy as np

from server.features.comparison.alignment import NoMomentError, find_moment
from server.features.comparison.decimation import decimate
from server.features.comparison.definitions import FIGURES
from server.features.comparison.differences import find_differences
from server.features.comparison.figures import (
    MEASURED,
    NEVER_ARMED,
    NOTHING_THERE,
    OUTPUT,
    SET_POINT,
    EvaluationRange,
    complete,
    count,
    measure,
)
from server.features.comparison.history import read_bookmarks, read_history, set_point_steps
from server.features.comparison.moments import ControlHistory, Span
from server.features.comparison.result_cache import ResultCache
from server.features.comparison.samples import Samples
from server.features.comparison.schemas import (
    Compared,
    Comparison,
    ComparisonQuery,
    Lines,
    LinesQuery,
    SessionLines,
    SignalLine,
    TimeRange,
)
from server.features.comparison.signals import Signal, list_signals, split
from server.features.sessions.missions import MissionStepStart, RecordedMission, read_missions
from server.features.sessions.recording import Recording, reading_content
from server.features.sessions.session import find_row
from server.features.sessions.timeline import Moment, read_events
from server.metrics.figure import Figure
from server.metrics.series import Floats
from server.platform.models import SessionRow
from server.platform.store import Reader

EVENTS_MAX = 500
RESULTS_MAX = 64
"""Of each cache of results about a session."""
THREADS = 2
"""Only decompression and SQLite run in parallel: more threads do not help."""


@dataclass(frozen=True, slots=True)
class _AlignedSession:
    """A session and its place on the common time axis."""

    recording: Recording
    history: ControlHistory
    steps: list[tuple[float, float]]
    markers: list[Moment]
    missions: list[RecordedMission]
    offset: float | None
    problem: str

    @property
    def row(self) -> SessionRow:
        return self.recording.row


class Comparer:
    """Compares sessions, called from several threads; results about complete sessions are cached.

    Methods raise UnknownSessionError, StoreError and RecordingError.
    """

    def __init__(self, store: Reader) -> None:
        self._store = store
        self._samples = Samples()
        self._threads = ThreadPoolExecutor(THREADS, "compare")
        self._histories: ResultCache[ControlHistory] = ResultCache(RESULTS_MAX)
        self._missions: ResultCache[list[RecordedMission]] = ResultCache(RESULTS_MAX)
        self._measured: ResultCache[dict[str, Figure]] = ResultCache(RESULTS_MAX)
        self._counted: ResultCache[dict[str, Figure]] = ResultCache(RESULTS_MAX)

    def signals(self, session: int) -> list[Signal]:
        """The signals of a session that can be drawn."""
        recording = self._open(session)
        with reading_content(recording.row):
            return list_signals(recording)

    def compare(self, query: ComparisonQuery) -> Comparison:
        """Lines, figures and differences of the sessions, in the order asked for."""
        aligned = self._align(query)

        def compare_one(one: _AlignedSession) -> Compared:
            with reading_content(one.row):
                return self._compare_one(one, query)

        return Comparison(
            align=query.align,
            signals=_chosen_signals(query.signals, aligned),
            sessions=list(self._threads.map(compare_one, aligned)),
            figures=list(FIGURES),
            differences=find_differences([(one.row, one.history) for one in aligned]),
        )

    def lines(self, query: LinesQuery) -> Lines:
        """The lines alone, for a part of the time."""
        aligned = self._align(query)
        drawn = [
            SessionLines(
                id=one.row.id or 0, offset=one.offset, problem=one.problem, series=self._draw(one, query)
            )
            for one in aligned
        ]
        return Lines(sessions=drawn)

    def _open(self, session: int) -> Recording:
        return Recording(self._store, find_row(self._store, session))

    def _align(self, query: LinesQuery) -> list[_AlignedSession]:
        recordings = [self._open(one) for one in dict.fromkeys(query.sessions)]
        return list(self._threads.map(lambda one: self._align_one(one, query), recordings))

    def _align_one(self, recording: Recording, query: LinesQuery) -> _AlignedSession:
        with reading_content(recording.row):
            return self._find_offset(recording, query)

    def _find_offset(self, recording: Recording, query: LinesQuery) -> _AlignedSession:
        # All at once, since the columns of a topic are read together.
        found = self._samples.read(recording, {*query.signals, MEASURED, SET_POINT, OUTPUT})
        history = self._histories.compute(recording.row, None, lambda: read_history(recording, self._samples))
        set_point = found.get(SET_POINT)
        steps = set_point_steps(set_point, history.armed) if set_point is not None else []
        bookmarks = read_bookmarks(self._store, recording)
        missions = self._missions.compute(recording.row, None, lambda: read_missions(recording)[0])
        try:
            offset, problem = find_moment(query.align, history, steps, bookmarks, missions), ""
        except NoMomentError as missing:
            offset, problem = None, str(missing)
        return _AlignedSession(recording, history, steps, bookmarks, missions, offset, problem)

    def _compare_one(self, one: _AlignedSession, query: ComparisonQuery) -> Compared:
        row = one.row
        taken = _range(one, query)
        return Compared(
            id=row.id or 0,
            name=row.name,
            started=row.started,
            duration=row.duration,
            state=row.state,
            offset=one.offset,
            problem=one.problem,
            armed=[(span.start, span.end) for span in one.history.armed],
            set_point_steps=len(one.steps),
            mission_steps=_first_starts(one.missions),
            events=read_events(one.recording, EVENTS_MAX),
            markers=one.markers,
            series=self._draw(one, query),
            range=[(span.start, span.end) for span in taken.spans],
            figures=self._measure(one, taken, query) if query.figures else {},
        )

    def _measure(
        self, one: _AlignedSession, taken: EvaluationRange, query: ComparisonQuery
    ) -> dict[str, Figure]:
        band = query.band
        if query.range is not None and one.offset is None:
            return complete({}, one.problem)
        measured = self._measured.compute(
            one.row,
            (taken, band),
            lambda: measure(one.recording, self._samples, one.history, taken, band),
        )
        counted = self._counted.compute(
            one.row, taken.spans, lambda: count(self._store, one.recording, taken.spans)
        )
        return complete(measured | counted, NOTHING_THERE if taken.spans else NEVER_ARMED)

    def _draw(self, one: _AlignedSession, query: LinesQuery) -> dict[str, SignalLine]:
        if one.offset is None:
            return {}
        view = _shift(query.view, one.offset) if query.view else Span(0.0, max(one.row.duration, 1e-3))
        found = self._samples.read(one.recording, query.signals)
        known = list_signals(one.recording, {split(name)[0] for name in found})
        angles = {signal.name for signal in known if signal.unit == "rad"}
        drawn = {
            name: decimate(found[name], view.start, view.end, query.points, angle=name in angles)
            for name in query.signals
            if name in found
        }
        return {
            name: SignalLine(time=_rounded(line.time, 4), low=_values(line.low), high=_values(line.high))
            for name, line in drawn.items()
        }


def _range(one: _AlignedSession, query: ComparisonQuery) -> EvaluationRange:
    if query.range is not None:
        return EvaluationRange(() if one.offset is None else (_shift(query.range, one.offset),))
    anchor = one.offset if query.align.by in ("armed", "set_point") else None
    return EvaluationRange(one.history.armed, anchor)


def _first_starts(missions: list[RecordedMission]) -> list[MissionStepStart]:
    found: dict[str, MissionStepStart] = {}
    for one in missions:
        for step in one.started:
            found.setdefault(step.path, step)
    return list(found.values())


def _shift(part: TimeRange, offset: float) -> Span:
    low, high = sorted((part.start, part.end))
    return Span(low + offset, max(high, low + 1e-3) + offset)


def _chosen_signals(names: Sequence[str], aligned: Sequence[_AlignedSession]) -> list[Signal]:
    known: dict[str, Signal] = {}
    topics = {split(name)[0] for name in names}
    for one in aligned:
        for signal in list_signals(one.recording, topics):
            known.setdefault(signal.name, signal)
    return [known[name] for name in names if name in known]


def _rounded(values: Floats, digits: int) -> list[float]:
    rounded: list[float] = np.round(values, digits).tolist()
    return rounded


def _values(values: Floats) -> list[float | None]:
    """With six significant digits; null where there is no number, which JSON lacks."""
    return [float(f"{one:.6g}") if isfinite(one) else None for one in values.tolist()]
