"""The film of a session: what there is of it, and parts."""

from typing import Annotated

from fastapi import Query
from fastapi.responses import Response

from server.http.heavy_requests import RecordingTurn, TooManyHeavyError
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.library.content import reading_content
from server.library.film import (
    PART_SECONDS_MAX,
    CodecMissingError,
    FilmDescription,
    NoFilmError,
    describe_film,
    film_part,
)
from server.library.opening import Moment, OpenRecording
from server.recording.session import UnknownSessionError

FILM_START = "Film-Start"
_REFUSALS = (UnknownSessionError, NoFilmError, CodecMissingError, TooManyHeavyError)

router = Operations(prefix="/api", tags=["sessions"])


@router.operation("GET /sessions/{session}/film", Need.VIEWER, *_REFUSALS)
def get_film(_: RecordingTurn, recording: OpenRecording) -> FilmDescription:
    """Return what there is of a session's film."""
    with reading_content(recording.row):
        return describe_film(recording)


@router.operation("GET /sessions/{session}/film/part", Need.VIEWER, *_REFUSALS, media_type="video/mp4")
def get_film_part(
    _: RecordingTurn,
    recording: OpenRecording,
    start: Moment,
    seconds: Annotated[float, Query(gt=0, le=PART_SECONDS_MAX, allow_inf_nan=False)] = 10.0,
) -> Response:
    """Return a part of the film as a fragmented MP4 file, from the picture that is shown at `start` on.

    It begins with a picture that needs none before it, perhaps a second earlier: the header `Film-Start` has
    its time (s since the session's start), which is 0 in the file.
    """
    zero = recording.row.started_steady
    with reading_content(recording.row):
        origin, part = film_part(recording, zero + start, seconds)
    headers = {FILM_START: f"{origin - zero:.6f}", "cache-control": "private, no-cache"}
    return Response(part, media_type="video/mp4", headers=headers)
