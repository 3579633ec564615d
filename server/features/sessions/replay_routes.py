"""Replay: a session's samples as the live socket carries them, and what its seek bar shows."""

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from server.features.sessions.dependencies import UNKNOWN, OpenRecording
from server.features.sessions.replay import HISTORY_MAX, read_stretch
from server.features.sessions.timeline import Timeline, read_timeline
from server.http.sign_in.policy import Need, needs
from server.platform.errors import InvalidError

SECONDS_MAX = 1e9
LEFT_OUT = "Left-Out"
"""The header that says how many samples could not be given."""

router = APIRouter(prefix="/api/sessions", tags=["sessions"])

Seconds = Annotated[float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False)]


@router.get(
    "/{session}/timeline",
    summary="Events and markers",
    operation_id="getTimeline",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
def get_timeline(recording: OpenRecording) -> Timeline:
    """What happened when in a session, and where nothing was recorded."""
    return read_timeline(recording)


@router.get(
    "/{session}/blocks",
    summary="A stretch of a session",
    operation_id="getBlocks",
    openapi_extra=needs(Need.VIEWER),
    response_class=Response,
    responses={
        200: {"content": {"application/octet-stream": {}}, "description": "Blocks, as on the live socket"},
        **UNKNOWN,
    },
)
def get_blocks(
    recording: OpenRecording,
    start: Seconds,
    end: Seconds,
    history: Annotated[float | None, Query(ge=0, le=HISTORY_MAX, allow_inf_nan=False)] = None,
) -> Response:
    """The samples of all topics from `start` up to `end`, in s since the session's start, in order of time.

    With a `history` (s), before them what was in force at `start`, and what the page's charts and lists show
    of the time before. The times in the blocks are the stored ones. The header `Left-Out` counts samples
    that are damaged or cannot be said in this version's definitions.
    """
    if end < start:
        raise InvalidError(f"The end, {end:g} s, lies before the start, {start:g} s.")
    zero = recording.row.started_steady
    stretch = read_stretch(recording, zero + start, zero + end, history)
    headers = {LEFT_OUT: str(stretch.left_out), "Cache-Control": "no-store"}
    return Response(stretch.data, media_type="application/octet-stream", headers=headers)
