"""Reads the sessions of a comparison as far as it needs to lay them over each other."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

from server.analysis.alignment import NoMomentError, find_moment
from server.analysis.figures import MEASURED, OUTPUT, SET_POINT
from server.analysis.history import read_bookmarks, set_point_steps
from server.analysis.likeness import choose_segments
from server.analysis.moments import ControlHistory
from server.analysis.schemas import LinesQuery
from server.analysis.segment import SEGMENTS_MAX, Segment
from server.analysis.session_reader import SessionReader
from server.library.content import Recording, reading_content
from server.library.missions import RecordedMission
from server.library.timeline import Moment
from server.platform.models import SessionRow


@dataclass(frozen=True, slots=True)
class AlignedSession:
    """A session and its position on the common time axis."""

    recording: Recording
    history: ControlHistory
    steps: list[tuple[float, float]]
    markers: list[Moment]
    missions: list[RecordedMission]
    segments: list[Segment]
    segment: Segment | None = None
    """The chosen one."""
    offset: float | None = None
    problem: str = ""

    @property
    def row(self) -> SessionRow:
        """The session's row."""
        return self.recording.row


class Aligner:
    """Finds the moment of each session that becomes 0 s."""

    def __init__(self, reader: SessionReader, threads: ThreadPoolExecutor) -> None:
        self._reader = reader
        self._threads = threads

    def align(self, query: LinesQuery) -> list[AlignedSession]:
        """Return the sessions, each once. Raise UnknownSessionError, StoreError, RecordingError."""
        recordings = [self._reader.open(number) for number in dict.fromkeys(query.sessions)]
        sessions = list(self._threads.map(lambda recording: self._read(recording, query), recordings))
        numbers = {choice.session: choice.segment for choice in query.segments}
        chosen = choose_segments(
            [session.segments for session in sessions],
            [numbers.get(session.row.id or 0) for session in sessions],
        )
        return [
            _find_offset(replace(session, segment=segment), query)
            for session, segment in zip(sessions, chosen, strict=True)
        ]

    def _read(self, recording: Recording, query: LinesQuery) -> AlignedSession:
        with reading_content(recording.row):
            # All at once, since the columns of a topic are read together.
            signals = self._reader.samples.read(recording, {*query.signals, MEASURED, SET_POINT, OUTPUT})
            history = self._reader.history(recording)
            set_point = signals.get(SET_POINT)
            return AlignedSession(
                recording,
                history,
                steps=set_point_steps(set_point, history.armed) if set_point is not None else [],
                markers=read_bookmarks(self._reader.store, recording),
                missions=self._reader.missions(recording),
                segments=self._reader.segments(recording)[:SEGMENTS_MAX],
            )


def _find_offset(session: AlignedSession, query: LinesQuery) -> AlignedSession:
    """Return the session with the moment that is 0 s, or the reason why it has none."""
    segment = None if session.segment is None else session.segment.span
    try:
        offset = find_moment(
            query.align, session.history, session.steps, session.markers, session.missions, segment
        )
    except NoMomentError as missing:
        return replace(session, problem=str(missing))
    return replace(session, offset=offset)
