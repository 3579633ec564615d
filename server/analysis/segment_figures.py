"""Figures of a dive: of all its armed time, of each of its segments, or of a part that somebody chose."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from math import inf

import numpy as np

from server.analysis.definitions import STORY_FIGURES
from server.analysis.figures import (
    MEASURED,
    NEVER_ARMED,
    NOTHING_THERE,
    SET_POINT,
    EvaluationRange,
    count_fin_strokes,
    count_losses,
    measure_series,
    read_losses,
)
from server.analysis.moments import ControlHistory, Span
from server.analysis.samples import Samples
from server.analysis.segment import SEGMENTS_MAX, Segment
from server.analysis.story_schemas import StoryFigures
from server.library.content import Recording
from server.library.timeline import EVENTS_MAX, read_events
from server.metrics.figure import Figure
from server.metrics.series import Series

_OF_A_STEP = ("cycle_amplitude", "overshoot", "settling_time")
DISARMING = 1.0
"""s from the end of an armed time until the alarm that ended it."""
NOT_HELD = "No depth was held."
NOTHING_HELD_THERE = "No depth was held in this range."
SEVERAL = "One number of several segments would mean little: see those of each."


class DiveFigures:
    """Computes figures of one session, whose signals are read once. Raise StoreError, RecordingError."""

    def __init__(
        self, recording: Recording, samples: Samples, history: ControlHistory, segments: Sequence[Segment]
    ) -> None:
        self._recording = recording
        self._history = history
        self._segments = segments
        self._series = samples.read(recording, [MEASURED, SET_POINT])
        self._losses = read_losses(recording)
        self._alarms = read_alarms(recording)

    def measure_all(self) -> StoryFigures:
        """Return the figures of the armed time, and of each segment."""
        armed = tuple(Span(max(span.start, 0.0), span.end) for span in self._history.armed)
        return StoryFigures(
            meanings=[*STORY_FIGURES],
            whole=self._measure(armed, NOT_HELD),
            segments=[
                self._measure((Span(segment.start, segment.end),), NOT_HELD)
                for segment in self._segments[:SEGMENTS_MAX]
            ],
        )

    def measure_part(self, start: float, end: float) -> StoryFigures:
        """Return the figures of a part of the time (s since the session's start)."""
        whole = self._measure((Span(start, end),), NOTHING_HELD_THERE)
        return StoryFigures(meanings=[*STORY_FIGURES], whole=whole, segments=[])

    def _measure(self, spans: tuple[Span, ...], not_held: str) -> dict[str, Figure]:
        if not spans:
            return _complete(count_losses(self._losses, (Span(0.0, inf),)), NEVER_ARMED)
        evaluated = EvaluationRange(spans)
        held = [*self._held(spans)]
        figures = measure_series(self._series, self._history, EvaluationRange(tuple(held))) if held else {}
        if len(held) > 1:
            figures |= dict.fromkeys(_OF_A_STEP, Figure(value=None, words=SEVERAL))
        figures |= count_losses(self._losses, spans)
        figures["duration"] = Figure(value=sum(span.end - span.start for span in spans))
        figures["deepest"] = find_deepest(self._series.get(MEASURED), evaluated)
        figures["fin_strokes"] = count_fin_strokes(self._recording, spans)
        starts = [segment.start for segment in self._segments]
        figures["alarms"] = count_alarms(self._alarms, spans, starts)
        return _complete(figures, NOTHING_THERE if held else not_held)

    def _held(self, spans: tuple[Span, ...]) -> Iterator[Span]:
        """Yield the parts of these spans in which the depth was held, one for each segment."""
        for segment in self._segments:
            for span in spans:
                start, end = max(span.start, segment.start), min(span.end, segment.end)
                if segment.holds_depth and start < end:
                    yield Span(start, end)


def read_alarms(recording: Recording) -> list[float]:
    """Return the times of the alarms, s since the session's start. Raise StoreError."""
    events = read_events(recording, EVENTS_MAX)
    return [event.time for event in events if event.severity == "alarm"]


def count_alarms(alarms: Iterable[float], spans: Sequence[Span], starts: Container[float] = ()) -> Figure:
    """Return the number of alarms in these spans; one that has just disarmed the robot at their end counts.

    It does not where a segment starts there, which has it.
    """
    return Figure(value=float(sum(_has_alarm(spans, starts, time) for time in alarms)))


def _has_alarm(spans: Sequence[Span], starts: Container[float], time: float) -> bool:
    return any(
        span.start <= time < span.end or (span.end <= time < span.end + DISARMING and span.end not in starts)
        for span in spans
    )


def find_deepest(depth: Series | None, evaluated: EvaluationRange) -> Figure:
    """Return the greatest depth in the range."""
    inside = np.empty(0) if depth is None else depth.values[evaluated.mask(depth.times)]
    if not inside.size:
        return Figure(value=None, words="The recording has no depth in this range.")
    return Figure(value=float(inside.max()))


def _complete(figures: Mapping[str, Figure], why: str) -> dict[str, Figure]:
    missing = Figure(value=None, words=why)
    return {meaning.name: figures.get(meaning.name, missing) for meaning in STORY_FIGURES}
