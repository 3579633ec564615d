"""The story of one session: depth, segments and flags, figures, track, and readings of a moment."""

from fastapi.responses import Response

from server.analysis.schemas import StoryFiguresQuery
from server.analysis.story_schemas import Story, StoryFigures, SwumTrack
from server.features.comparison.parts import PartEnd, PartStart, read_part
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, RecordingTurn, TooManyHeavyError
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.library.content import reading_content
from server.library.opening import Moment, OpenRecording
from server.library.readings import Readings, read_readings
from server.platform.errors import InvalidError
from server.recording.session import UnknownSessionError

router = Operations(prefix="/api", tags=["sessions"])

_ERRORS = (UnknownSessionError, TooManyHeavyError, ComparisonError)


@router.operation("GET /sessions/{session}/story", Need.VIEWER, *_ERRORS, response_model=Story)
async def get_story(_: ReadingTurn, worker: Provided[ComparisonWorker], session: Identifier) -> Response:
    """Return a session as one dive: depth, set point, segments, and what happened.

    A segment is a time between two changes of mode, controller, gains or set point, while the robot is armed.
    Of a session that still records it is what is stored by now.
    """
    return _json(await worker.ask("story", str(session)))


@router.operation("GET /sessions/{session}/track", Need.VIEWER, *_ERRORS, response_model=list[SwumTrack])
async def get_track(_: ReadingTurn, worker: Provided[ComparisonWorker], session: Identifier) -> Response:
    """Return the tracks of a session, one of each arming: dead reckoning, with the truth where simulated."""
    return _json(await worker.ask("track", str(session)))


@router.operation(
    "GET /sessions/{session}/story/figures",
    Need.VIEWER,
    *_ERRORS,
    InvalidError,
    response_model=StoryFigures,
)
async def get_story_figures(
    _: ReadingTurn,
    worker: Provided[ComparisonWorker],
    session: Identifier,
    start: PartStart = None,
    end: PartEnd = None,
) -> Response:
    """Return the figures of a session's armed time and of each segment; with `from` and `to` of that part."""
    query = StoryFiguresQuery(session=session, part=read_part(start, end))
    return _json(await worker.ask("story_figures", query.model_dump_json()))


@router.operation("GET /sessions/{session}/readings", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def get_readings(_: RecordingTurn, recording: OpenRecording, time: Moment) -> Readings:
    """Return depth, attitude, fins and battery at a moment of a session."""
    with reading_content(recording.row):
        return read_readings(recording, time)


def _json(data: bytes) -> Response:
    return Response(data, media_type="application/json")
