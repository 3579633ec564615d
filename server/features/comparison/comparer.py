"""Lays sessions over each other."""

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
from server.features.comparison.history import (
    read_history,
    read_markers,
    set_point_steps,
)
from server.features.comparison.moments import ControlHistory, Span
from server.features.comparison.result_cache import Kept
from server.features.comparison.samples import Samples
from server.features.comparison.schemas import (
    Compared,
    Comparison,
    Drawn,
    Lines,
    SignalLine,
    TimeRange,
    WantedComparison,
    WantedLines,
)
from server.features.comparison.signals import Signal, list_signals, split
from server.features.metrics.figure import Figure
from server.features.metrics.series import Floats
from server.features.sessions.recording import Recording
from server.features.sessions.session import UnknownSessionError, find_row
from server.features.sessions.timeline import Moment, read_events
from server.platform.models import SessionRow
from server.platform.store import Reader

EVENTS_MAX = 500
THREADS = 2
"""Decompression and SQLite let others run, Python itself does not: more are of no use."""


@dataclass(frozen=True, slots=True)
class _Laid:
    """A session, and where it lies on the common time axis."""

    recording: Recording
    history: ControlHistory
    steps: list[tuple[float, float]]
    markers: list[Moment]
    offset: float | None
    problem: str

    @property
    def row(self) -> SessionRow:
        return self.recording.row


class Comparer:
    """Answers comparisons, from several threads; what it found out about complete sessions is kept a while.

    Methods raise UnknownSessionError, StoreError and RecordingError.
    """

    def __init__(self, store: Reader) -> None:
        self._store = store
        self._samples = Samples()
        self._threads = ThreadPoolExecutor(THREADS, "compare")
        self._histories: Kept[ControlHistory] = Kept()
        self._measured: Kept[dict[str, Figure]] = Kept()
        self._counted: Kept[dict[str, Figure]] = Kept()

    def signals(self, session: int) -> list[Signal]:
        """What of a session can be drawn."""
        return list_signals(self._open(session))

    def compare(self, wanted: WantedComparison) -> Comparison:
        """Lines, figures and differences of the sessions, in the order asked for."""
        laid = self._lay(wanted)
        return Comparison(
            align=wanted.align,
            signals=_wanted_signals(wanted.signals, laid),
            sessions=list(self._threads.map(lambda one: self._compare_one(one, wanted), laid)),
            figures=list(FIGURES),
            differences=find_differences([(one.row, one.history) for one in laid]),
        )

    def lines(self, wanted: WantedLines) -> Lines:
        """The lines alone, for a part of the time."""
        laid = self._lay(wanted)
        return Lines(
            sessions=[
                Drawn(
                    id=one.row.id or 0, offset=one.offset, problem=one.problem, series=self._draw(one, wanted)
                )
                for one in laid
            ]
        )

    def _open(self, session: int) -> Recording:
        row = find_row(self._store, session)
        if row is None:
            raise UnknownSessionError(session)
        return Recording(self._store, row)

    def _lay(self, wanted: WantedLines) -> list[_Laid]:
        recordings = [self._open(one) for one in dict.fromkeys(wanted.sessions)]
        return list(self._threads.map(lambda one: self._lay_one(one, wanted), recordings))

    def _lay_one(self, recording: Recording, wanted: WantedLines) -> _Laid:
        # At once, since what is wanted of one topic is read together.
        found = self._samples.read(recording, {*wanted.signals, MEASURED, SET_POINT, OUTPUT})
        key = (recording.row.identifier,)
        history = self._histories.recall(key)
        if history is None:
            history = read_history(recording, self._samples)
            self._histories.keep(key, history, recording.row)
        set_point = found.get(SET_POINT)
        steps = set_point_steps(set_point, history.armed) if set_point is not None else []
        markers = read_markers(self._store, recording)
        try:
            offset, problem = find_moment(wanted.align, history, steps, markers), ""
        except NoMomentError as missing:
            offset, problem = None, str(missing)
        return _Laid(recording, history, steps, markers, offset, problem)

    def _compare_one(self, one: _Laid, wanted: WantedComparison) -> Compared:
        row = one.row
        taken = _range(one, wanted)
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
            events=read_events(one.recording, EVENTS_MAX),
            markers=one.markers,
            series=self._draw(one, wanted),
            range=[(span.start, span.end) for span in taken.spans],
            figures=self._measure(one, taken, wanted),
        )

    def _measure(self, one: _Laid, taken: EvaluationRange, wanted: WantedComparison) -> dict[str, Figure]:
        band = wanted.band
        if wanted.range is not None and one.offset is None:
            return complete({}, one.problem)
        key = (one.row.identifier, taken, band)
        measured = self._measured.recall(key)
        if measured is None:
            measured = measure(one.recording, self._samples, one.history, taken, band)
            self._measured.keep(key, measured, one.row)
        place = (one.row.identifier, taken.spans)
        counted = self._counted.recall(place)
        if counted is None:
            counted = count(self._store, one.recording, taken.spans)
            self._counted.keep(place, counted, one.row)
        return complete(measured | counted, NOTHING_THERE if taken.spans else NEVER_ARMED)

    def _draw(self, one: _Laid, wanted: WantedLines) -> dict[str, SignalLine]:
        if one.offset is None:
            return {}
        view = _shift(wanted.view, one.offset) if wanted.view else Span(0.0, max(one.row.duration, 1e-3))
        found = self._samples.read(one.recording, wanted.signals)
        drawn = {
            name: decimate(found[name], view.start, view.end, wanted.points)
            for name in wanted.signals
            if name in found
        }
        return {
            name: SignalLine(time=_rounded(line.time, 4), low=_values(line.low), high=_values(line.high))
            for name, line in drawn.items()
        }


def _range(one: _Laid, wanted: WantedComparison) -> EvaluationRange:
    if wanted.range is not None:
        return EvaluationRange(() if one.offset is None else (_shift(wanted.range, one.offset),))
    anchor = one.offset if wanted.align.by in ("armed", "set_point") else None
    return EvaluationRange(one.history.armed, anchor)


def _shift(part: TimeRange, offset: float) -> Span:
    low, high = sorted((part.start, part.end))
    return Span(low + offset, max(high, low + 1e-3) + offset)


def _wanted_signals(names: Sequence[str], laid: Sequence[_Laid]) -> list[Signal]:
    known: dict[str, Signal] = {}
    topics = {split(name)[0] for name in names}
    for one in laid:
        for signal in list_signals(one.recording, topics):
            known.setdefault(signal.name, signal)
    return [known[name] for name in names if name in known]


def _rounded(values: Floats, digits: int) -> list[float]:
    rounded: list[float] = np.round(values, digits).tolist()
    return rounded


def _values(values: Floats) -> list[float | None]:
    """With six significant digits; null where there is no number, which JSON lacks."""
    return [float(f"{one:.6g}") if isfinite(one) else None for one in values.tolist()]
