"""Reads what several analyses of a session need: its signals, its history, its segments, its missions."""

from server.analysis.figures import SET_POINT
from server.analysis.history import read_history
from server.analysis.moments import ControlHistory
from server.analysis.result_cache import ResultCache
from server.analysis.samples import Samples
from server.analysis.segment import Segment
from server.analysis.segments import find_segments
from server.library.content import Recording
from server.library.missions import RecordedMission, read_missions
from server.platform.store import Reader


class SessionReader:
    """Parts of sessions, cached where the session is complete; several threads may read.

    Methods raise UnknownSessionError, StoreError and RecordingError.
    """

    def __init__(self, store: Reader) -> None:
        self.store = store
        self.samples = Samples()
        self._histories: ResultCache[ControlHistory] = ResultCache()
        self._segments: ResultCache[list[Segment]] = ResultCache()
        self._missions: ResultCache[list[RecordedMission]] = ResultCache()

    def open(self, session: int) -> Recording:
        """Return the recording of a session."""
        return Recording.open(self.store, session)

    def history(self, recording: Recording) -> ControlHistory:
        """Return armed times, controllers and settings of the session."""
        return self._histories.compute(recording.row, None, lambda: read_history(recording, self.samples))

    def segments(self, recording: Recording) -> list[Segment]:
        """Return all segments of the session, in order of time."""

        def find() -> list[Segment]:
            set_point = self.samples.read(recording, [SET_POINT]).get(SET_POINT)
            return find_segments(self.history(recording), set_point, recording.row.duration)

        return self._segments.compute(recording.row, None, find)

    def missions(self, recording: Recording) -> list[RecordedMission]:
        """Return the missions of the session, the first of very many."""
        return self._missions.compute(recording.row, None, lambda: read_missions(recording)[0])
