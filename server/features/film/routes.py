"""The film: the choice of it, what a session has of it, and parts."""

from typing import Annotated

from fastapi import Query
from fastapi.responses import Response

from server.features.film.choice import FilmChoice
from server.features.film.config import FilmConfig
from server.features.film.schemas import FilmOrder, FilmPlan, PictureBytes
from server.http.dependencies import Provided
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
from server.library.storage import free_for_recordings
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import UnknownSessionError

FILM_START = "Film-Start"

router = Operations(prefix="/api", tags=["sessions"])


@router.operation("GET /film", Need.VIEWER)
def get_film_plan(
    choice: Provided[FilmChoice], store: Provided[Store], settings: Provided[Settings]
) -> FilmPlan:
    """Return the choice of a film that is in force, and the space that films need."""
    now = choice.now
    return FilmPlan(
        record=now.record,
        rate=min(now.rate, choice.rate_max),
        quality=now.quality,
        rate_max=choice.rate_max,
        coding=choice.coding,
        refusal=choice.refusal,
        picture_bytes=PictureBytes(**choice.picture_bytes),
        measured=choice.is_measured,
        room=max(0, free_for_recordings(store, settings)),
    )


@router.operation("PUT /film", Need.OPERATOR, status_code=204)
async def choose_film(choice: Provided[FilmChoice], body: FilmOrder) -> None:
    """Choose whether and how sessions are filmed: the one that records at once, and those to come."""
    await choice.change(FilmConfig(record=body.record, rate=body.rate, quality=body.quality))


_REFUSALS = (UnknownSessionError, NoFilmError, CodecMissingError, TooManyHeavyError)


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
