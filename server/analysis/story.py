"""The story of a dive: its depth, its segments, what happened, its figures and its track."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from server.analysis.decimation import decimate
from server.analysis.figures import MEASURED, SET_POINT
from server.analysis.flags import gather_flags
from server.analysis.history import read_bookmarks
from server.analysis.moments import ControlHistory
from server.analysis.result_cache import ResultCache
from server.analysis.schemas import SignalLine, TimeRange
from server.analysis.segment import SEGMENTS_MAX, Segment
from server.analysis.segment_figures import DiveFigures
from server.analysis.session_reader import SessionReader
from server.analysis.story_schemas import Story, StoryFigures, SwumTrack
from server.analysis.track import ESTIMATE, TRUE, find_tracks
from server.library.content import Recording, reading_content
from server.library.timeline import EVENTS_MAX, read_events
from server.metrics.series import Series

COLUMNS = 1500
"""Of the line of the depth: as many as pixels of a page."""
SIGNALS = (MEASURED, SET_POINT)


class StoryTeller:
    """Stories of sessions; those of complete ones are cached.

    Methods raise UnknownSessionError, StoreError and RecordingError.
    """

    def __init__(self, reader: SessionReader, threads: ThreadPoolExecutor) -> None:
        self._reader = reader
        self._threads = threads
        self._stories: ResultCache[Story] = ResultCache()
        self._measured: ResultCache[StoryFigures] = ResultCache()
        self._tracks: ResultCache[list[SwumTrack]] = ResultCache()

    def tell(self, session: int) -> Story:
        """Return the story of a session."""
        recording = self._reader.open(session)
        with reading_content(recording.row):
            # Both take a second where a dive lasts hours.
            reading = self._threads.submit(self._reader.history, recording)
            self._reader.samples.read(recording, SIGNALS)
            history = reading.result()
            story = self._stories.compute(recording.row, None, lambda: self._tell(recording, history))
            events, missions = read_events(recording, EVENTS_MAX), self._reader.missions(recording)
            # Bookmarks change after the dive, too: what depends on them is not cached.
            flags = gather_flags(events, read_bookmarks(self._reader.store, recording), missions, history)
            return story.model_copy(update={"flags": flags})

    def track(self, session: int) -> list[SwumTrack]:
        """Return the tracks of a session, one of each arming."""
        recording = self._reader.open(session)

        def find() -> list[SwumTrack]:
            estimate = self._reader.samples.read(recording, ESTIMATE)
            # Reading the others takes seconds where a dive lasts hours.
            others = self._reader.samples.read(recording, [*TRUE, MEASURED]) if estimate else {}
            return find_tracks(estimate | others, self._reader.history(recording).armed)

        with reading_content(recording.row):
            return self._tracks.compute(recording.row, None, find)

    def measure(self, session: int, part: TimeRange | None) -> StoryFigures:
        """Return the figures of a session and of its segments, or of a part of its time alone."""
        recording = self._reader.open(session)

        def compute() -> StoryFigures:
            history = self._reader.history(recording)
            segments = self._reader.segments(recording)
            figures = DiveFigures(recording, self._reader.samples, history, segments)
            return figures.measure_all() if part is None else figures.measure_part(part.start, part.end)

        with reading_content(recording.row):
            return self._measured.compute(recording.row, part and (part.start, part.end), compute)

    def _tell(self, recording: Recording, history: ControlHistory) -> Story:
        series = self._reader.samples.read(recording, SIGNALS)
        duration = max(recording.row.duration, 1e-3)
        depth, set_point = series.get(MEASURED), series.get(SET_POINT)
        segments = self._reader.segments(recording)
        held = None if set_point is None else _while_held(set_point, segments)
        return Story(
            duration=recording.row.duration,
            water=history.water,
            depth=None if depth is None else SignalLine.of(decimate(depth, 0.0, duration, COLUMNS)),
            set_point=None if held is None else SignalLine.of(decimate(held, 0.0, duration, COLUMNS)),
            segments=segments[:SEGMENTS_MAX],
            segment_count=len(segments),
            flags=[],
        )


def _while_held(set_point: Series, segments: list[Segment]) -> Series | None:
    """Return the set point where a segment holds the depth, NaN elsewhere; None where none does."""
    held = np.zeros(set_point.times.size, bool)
    for segment in segments:
        if segment.holds_depth:
            first, last = np.searchsorted(set_point.times, [segment.start, segment.end])
            held[first:last] = True
    return Series(set_point.times, np.where(held, set_point.values, np.nan)) if held.any() else None
