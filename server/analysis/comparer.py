"""Compares sessions on one time axis."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from server.analysis.aligner import AlignedSession, Aligner
from server.analysis.decimation import decimate
from server.analysis.definitions import FIGURES
from server.analysis.differences import find_differences
from server.analysis.figures import (
    NEVER_ARMED,
    NOTHING_THERE,
    EvaluationRange,
    complete,
    count,
    measure,
)
from server.analysis.likeness import NO_SEGMENT, judge, parts_within
from server.analysis.moments import Span
from server.analysis.result_cache import ResultCache
from server.analysis.schemas import (
    Compared,
    Comparison,
    ComparisonQuery,
    Lines,
    LinesQuery,
    SessionLines,
    SignalLine,
    TimeRange,
)
from server.analysis.session_reader import SessionReader
from server.analysis.signals import Signal, list_signals, split
from server.analysis.story import StoryTeller
from server.analysis.study import Study
from server.library.content import reading_content
from server.library.missions import MissionStepStart, RecordedMission
from server.library.timeline import read_events
from server.metrics.figure import Figure
from server.platform.store import Reader

EVENTS_MAX = 500
THREADS = 2
"""Only decompression and SQLite run in parallel: more threads do not help."""


class Comparer:
    """Comparison of sessions, called from several threads; results about complete sessions are cached.

    Methods raise UnknownSessionError, StoreError and RecordingError.
    """

    def __init__(self, store: Reader) -> None:
        self.reader = SessionReader(store)
        self._threads = ThreadPoolExecutor(THREADS, "compare")
        self._measured: ResultCache[dict[str, Figure]] = ResultCache()
        self._counted: ResultCache[dict[str, Figure]] = ResultCache()
        self._aligner = Aligner(self.reader, self._threads)
        self.study = Study(self.reader)
        self.stories = StoryTeller(self.reader, self._threads)

    def signals(self, session: int) -> list[Signal]:
        """Return the signals of a session that can be drawn."""
        recording = self.reader.open(session)
        with reading_content(recording.row):
            return list_signals(recording)

    def compare(self, query: ComparisonQuery) -> Comparison:
        """Return lines, figures and differences of the sessions, in the requested order."""
        aligned = self._aligner.align(query)

        def compare_one(session: AlignedSession) -> Compared:
            with reading_content(session.row):
                return self._compare_one(session, query)

        return Comparison(
            align=query.align,
            signals=_chosen_signals(query.signals, aligned),
            sessions=list(self._threads.map(compare_one, aligned)),
            figures=list(FIGURES),
            likeness=judge(
                [
                    (session.row.name, parts_within(session.segments, _range(session, query).spans))
                    for session in aligned
                ]
            ),
            differences=find_differences([(session.row, session.history) for session in aligned]),
        )

    def lines(self, query: LinesQuery) -> Lines:
        """Return the lines alone, for a part of the time."""
        aligned = self._aligner.align(query)
        drawn = [
            SessionLines(
                id=session.row.id or 0,
                offset=session.offset,
                problem=session.problem,
                series=self._draw(session, query),
            )
            for session in aligned
        ]
        return Lines(sessions=drawn)

    def _compare_one(self, session: AlignedSession, query: ComparisonQuery) -> Compared:
        row = session.row
        taken = _range(session, query)
        return Compared(
            id=row.id or 0,
            name=row.name,
            started=row.started,
            duration=row.duration,
            state=row.state,
            offset=session.offset,
            problem=session.problem,
            armed=[(span.start, span.end) for span in session.history.armed],
            set_point_steps=len(session.steps),
            mission_steps=_first_starts(session.missions),
            segments=session.segments,
            segment=None if session.segment is None else session.segments.index(session.segment) + 1,
            events=read_events(session.recording, EVENTS_MAX),
            markers=session.markers,
            series=self._draw(session, query),
            range=[(span.start, span.end) for span in taken.spans],
            figures=self._measure(session, taken, query) if query.figures else {},
        )

    def _measure(
        self, session: AlignedSession, taken: EvaluationRange, query: ComparisonQuery
    ) -> dict[str, Figure]:
        band = query.band
        if query.range is not None and session.offset is None:
            return complete({}, session.problem)
        if query.range is None and query.over == "segment" and session.segment is None:
            return complete({}, NO_SEGMENT)
        measured = self._measured.compute(
            session.row,
            (taken, band),
            lambda: measure(session.recording, self.reader.samples, session.history, taken, band),
        )
        counted = self._counted.compute(
            session.row, taken.spans, lambda: count(self.reader.store, session.recording, taken.spans)
        )
        return complete(measured | counted, NOTHING_THERE if taken.spans else NEVER_ARMED)

    def _draw(self, session: AlignedSession, query: LinesQuery) -> dict[str, SignalLine]:
        if session.offset is None:
            return {}
        view = (
            _shift(query.view, session.offset) if query.view else Span(0.0, max(session.row.duration, 1e-3))
        )
        signals = self.reader.samples.read(session.recording, query.signals)
        known = list_signals(session.recording, {split(name)[0] for name in signals})
        angles = {signal.name for signal in known if signal.unit == "rad"}
        drawn = {
            name: decimate(signals[name], view.start, view.end, query.points, angle=name in angles)
            for name in query.signals
            if name in signals
        }
        return {name: SignalLine.of(line) for name, line in drawn.items()}


def _range(session: AlignedSession, query: ComparisonQuery) -> EvaluationRange:
    if query.range is not None:
        return EvaluationRange(() if session.offset is None else (_shift(query.range, session.offset),))
    if query.over == "segment":
        return EvaluationRange(() if session.segment is None else (session.segment.span,))
    anchor = session.offset if query.align.by in ("armed", "set_point") else None
    return EvaluationRange(session.history.armed, anchor)


def _first_starts(missions: list[RecordedMission]) -> list[MissionStepStart]:
    starts: dict[str, MissionStepStart] = {}
    for mission in missions:
        for step in mission.started:
            starts.setdefault(step.path, step)
    return list(starts.values())


def _shift(part: TimeRange, offset: float) -> Span:
    low, high = sorted((part.start, part.end))
    return Span(low + offset, max(high, low + 1e-3) + offset)


def _chosen_signals(names: Sequence[str], aligned: Sequence[AlignedSession]) -> list[Signal]:
    known: dict[str, Signal] = {}
    topics = {split(name)[0] for name in names}
    for session in aligned:
        for signal in list_signals(session.recording, topics):
            known.setdefault(signal.name, signal)
    return [known[name] for name in names if name in known]
