"""Sessions: recording, search, description, bookmarks, replay, and the storage that they take."""

import json
from typing import Annotated

from fastapi import APIRouter, Path, Query
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from robot_runtime.clock import Clock
from server.features.sessions.bookmarks import Bookmarks
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.dependencies import STORING, UNKNOWN, Identifier, OpenRecording
from server.features.sessions.recorder import Recorder, RecordingRefusedError
from server.features.sessions.replay import HISTORY_MAX, read_stretch
from server.features.sessions.retention import RetentionWorker
from server.features.sessions.schemas import (
    Bookmark,
    BookmarkChanges,
    NewBookmark,
    NewSession,
    Origin,
    Session,
    SessionChanges,
    SessionDetail,
)
from server.features.sessions.session import new_row
from server.features.sessions.storage import Storage, measure
from server.features.sessions.timeline import Timeline, read_timeline
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.errors import InvalidError, NotFoundError
from server.platform.models import IDENTIFIER_MAX
from server.platform.settings import Settings
from server.platform.store import Store
from server.stream.bridge import Bridge

SECONDS_MAX = 1e9
LEFT_OUT = "Left-Out"
"""The header that says how many samples could not be given."""

router = APIRouter(prefix="/api", tags=["sessions"])

UNKNOWN_MARK = answers(_404="There is no such session, or it has no such mark")

MarkIdentifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]
Seconds = Annotated[float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False)]


@router.get(
    "/sessions",
    summary="Sessions, newest first",
    operation_id="listSessions",
    openapi_extra=needs(Need.VIEWER),
)
def get_sessions(
    catalogue: Provided[Catalogue],
    search: Annotated[
        str, Query(max_length=200, description="words that name, note, tags or scenario have")
    ] = "",
    tag: Annotated[list[str] | None, Query(description="tags that they have, all of them")] = None,
    origin: Origin | None = None,
    deleted: Annotated[bool, Query(description="those in the bin instead")] = False,
) -> list[Session]:
    """Sessions that are to be found by all that is asked."""
    return catalogue.list(search, tag or (), origin, deleted=deleted)


@router.post(
    "/sessions",
    status_code=201,
    summary="Start recording",
    operation_id="startSession",
    openapi_extra=needs(Need.OPERATOR),
    responses=STORING,
)
async def start_session(
    bridge: Provided[Bridge],
    watch: Provided[HealthMonitor],
    settings: Provided[Settings],
    clock: Provided[Clock],
    recorder: Provided[Recorder],
    body: NewSession,
) -> Session:
    """Record everything from now on; refused while another session records or a test uses the board."""
    if bridge.reserved_reason is not None:
        raise RecordingRefusedError(bridge.reserved_reason)
    state = json.dumps(watch.state())
    try:
        row = await run_in_threadpool(new_row, settings, clock, body.name, body.note, state)
    except OSError as problem:
        raise RecordingRefusedError(
            f"The configuration {settings.config} cannot be read: {problem}"
        ) from problem
    return await recorder.start(row)


@router.get(
    "/sessions/{session}",
    summary="One session",
    operation_id="getSession",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
def get_session(catalogue: Provided[Catalogue], session: Identifier) -> SessionDetail:
    """One session with everything that is known of it, but its samples; also from the bin."""
    return catalogue.detail(session)


@router.patch(
    "/sessions/{session}",
    summary="Name, note, tag or keep a session",
    operation_id="changeSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def change_session(
    catalogue: Provided[Catalogue], session: Identifier, body: SessionChanges
) -> Session:
    """Change what people say about it; tags are replaced as a whole."""
    return await catalogue.change(session, **body.model_dump())


@router.post(
    "/sessions/{session}/stop",
    summary="Stop recording",
    operation_id="stopSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def stop_session(
    catalogue: Provided[Catalogue], recorder: Provided[Recorder], session: Identifier
) -> Session:
    """Stop recording; everything that arrived before is stored when this answers."""
    await run_in_threadpool(catalogue.find, session)
    return await recorder.stop(session)


@router.delete(
    "/sessions/{session}",
    summary="Put a session into the bin",
    operation_id="deleteSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def delete_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """It can be restored until it is purged, or until `sessions.undo_days` have passed."""
    return await catalogue.delete(session)


@router.post(
    "/sessions/{session}/restore",
    summary="Take a session out of the bin",
    operation_id="restoreSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def restore_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """Undo its deletion."""
    return await catalogue.restore(session)


@router.post(
    "/sessions/{session}/purge",
    status_code=204,
    summary="Remove a session that is in the bin for good",
    operation_id="purgeSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def purge_session(
    catalogue: Provided[Catalogue], retention: Provided[RetentionWorker], session: Identifier
) -> None:
    """It is gone at once; the room that it took comes back little by little."""
    await catalogue.purge(session)
    retention.wake()


@router.get(
    "/sessions/{session}/thumbnail",
    summary="A small picture of what the camera saw",
    operation_id="getThumbnail",
    openapi_extra=needs(Need.VIEWER),
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "The picture"}, **UNKNOWN},
)
def get_thumbnail(
    recording: OpenRecording, time: Annotated[float, Query(description="s since the start")]
) -> Response:
    """The first from this time on."""
    for _, jpeg in recording.pictures("thumbnail", recording.row.started_steady + time):
        return Response(jpeg, media_type="image/jpeg", headers={"cache-control": "max-age=86400"})
    raise NotFoundError(f"Session {recording.row.id} has no picture from {time:g} s on.")


@router.post(
    "/sessions/{session}/markers",
    status_code=201,
    summary="Mark a moment",
    operation_id="addMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN_MARK, **STORING},
)
async def add_mark(
    markers: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, body: NewBookmark
) -> Bookmark:
    """Mark a moment, now or later; refused beyond the session's end, and without a time once it has ended."""
    mark = await markers.add(session, body.time, body.text)
    catalogue.notify(session)
    return mark


@router.patch(
    "/sessions/{session}/markers/{mark}",
    summary="Change a mark",
    operation_id="changeMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN_MARK, **STORING},
)
async def change_mark(
    markers: Provided[Bookmarks], session: Identifier, mark: MarkIdentifier, body: BookmarkChanges
) -> Bookmark:
    """Move it, or say something else of it."""
    return await markers.change(session, mark, body.time, body.text)


@router.delete(
    "/sessions/{session}/markers/{mark}",
    status_code=204,
    summary="Take a mark away",
    operation_id="removeMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN_MARK, **STORING},
)
async def remove_mark(
    markers: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, mark: MarkIdentifier
) -> None:
    """Take it away for good."""
    await markers.remove(session, mark)
    catalogue.notify(session)


@router.get(
    "/sessions/{session}/timeline",
    summary="Events and markers",
    operation_id="getTimeline",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
def get_timeline(recording: OpenRecording) -> Timeline:
    """A session's events, bookmarks and gaps."""
    return read_timeline(recording)


@router.get(
    "/sessions/{session}/blocks",
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


@router.get(
    "/storage", summary="Storage used and free", operation_id="getStorage", openapi_extra=needs(Need.VIEWER)
)
def get_storage(store: Provided[Store], settings: Provided[Settings]) -> Storage:
    """The disk that holds the data folder, and the rules by which sessions go."""
    return measure(store, settings)
