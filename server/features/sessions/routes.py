"""Sessions: recording, search, description, bookmarks, replay, and the storage that they take."""

import json
from typing import Annotated

from fastapi import Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from robot_runtime.clock import Clock
from server.features.sessions.bookmarks import Bookmarks
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.listing import PAGE, PAGE_MAX
from server.features.sessions.missions import RecordedMission, read_missions
from server.features.sessions.recorder import Recorder, RecordingRefusedError
from server.features.sessions.recording import Recording, reading_content
from server.features.sessions.replay import HISTORY_MAX, read_blocks_between
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
    State,
)
from server.features.sessions.session import UnknownSessionError, find_row, new_row
from server.features.sessions.storage import Storage, measure
from server.features.sessions.timeline import Timeline, read_timeline
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.heavy_requests import RecordingTurn, TooManyHeavyError
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.platform.errors import ConflictError, InvalidError, NotFoundError
from server.platform.models import IDENTIFIER_MAX
from server.platform.settings import Settings
from server.platform.store import Store
from server.stream.bridge import Bridge

SECONDS_MAX = 1e9
LEFT_OUT = "Left-Out"
"""The header that says how many samples, or missions, are not in the answer."""
TOTAL_COUNT = "Total-Count"
"""The header that says how many sessions match."""

router = Operations(prefix="/api", tags=["sessions"])

NO_BOOKMARK = {404: "There is no such session, or it has no such bookmark"}

Seconds = Annotated[float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False)]


def _open(store: Provided[Store], session: Identifier) -> Recording:
    return Recording(store, find_row(store, session))


OpenRecording = Annotated[Recording, Depends(_open)]
"""The recording of the session in the path, also from the bin."""


@router.operation("GET /sessions", Need.VIEWER)
def list_sessions(
    catalogue: Provided[Catalogue],
    request: Request,
    response: Response,
    search: Annotated[
        str, Query(max_length=200, description="words that name, note, tags or scenario have")
    ] = "",
    tag: Annotated[list[str] | None, Query(description="tags that they have, all of them")] = None,
    origin: Origin | None = None,
    state: State | None = None,
    deleted: Annotated[bool, Query(description="those in the bin instead")] = False,
    before: Annotated[
        int | None, Query(ge=1, le=IDENTIFIER_MAX, description="only sessions of lower numbers")
    ] = None,
    limit: Annotated[int, Query(ge=1, le=PAGE_MAX, description="sessions in the answer")] = PAGE,
) -> list[Session]:
    """List the sessions that match every given condition, newest first, a page at a time.

    The header `Total-Count` says how many match. Where more follow, the header `Link` has the next page's
    address (`rel="next"`): the same with `before` as the last number of this one.
    """
    page = catalogue.page(search, tag or (), origin, state=state, deleted=deleted, before=before, limit=limit)
    response.headers[TOTAL_COUNT] = str(page.total)
    if page.following is not None:
        following = request.url.include_query_params(before=page.following)
        response.headers["Link"] = f'<{following.path}?{following.query}>; rel="next"'
    return page.sessions


@router.operation("GET /tags", Need.VIEWER)
def list_tags(catalogue: Provided[Catalogue]) -> list[str]:
    """List the tags of the sessions, those of most sessions first; at most a hundred."""
    return catalogue.tags()


@router.operation("POST /sessions", Need.OPERATOR, ConflictError, status_code=201)
async def start_session(
    bridge: Provided[Bridge],
    monitor: Provided[HealthMonitor],
    settings: Provided[Settings],
    clock: Provided[Clock],
    recorder: Provided[Recorder],
    body: NewSession,
) -> Session:
    """Start recording everything; refused while another session records or a test uses the board."""
    if bridge.reserved_reason is not None:
        raise RecordingRefusedError(bridge.reserved_reason)
    state = json.dumps(monitor.state())
    row = await run_in_threadpool(new_row, settings, clock, body.name, body.note, state)
    return await recorder.start(row)


@router.operation("GET /sessions/{session}", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def get_session(_: RecordingTurn, catalogue: Provided[Catalogue], session: Identifier) -> SessionDetail:
    """Return a session with everything that is known of it except its samples; also from the bin.

    Long lists are cut off: `markers` and `gap_count` count all, and an archive of the session has all.
    """
    return catalogue.detail(session)


@router.operation("PATCH /sessions/{session}", Need.OPERATOR, UnknownSessionError, ConflictError)
async def change_session(
    catalogue: Provided[Catalogue], session: Identifier, body: SessionChanges
) -> Session:
    """Change name, note, tags or protection of a session; tags are replaced as a whole."""
    return await catalogue.change(session, **body.model_dump())


@router.operation("POST /sessions/{session}/stop", Need.OPERATOR, UnknownSessionError, ConflictError)
async def stop_session(
    catalogue: Provided[Catalogue], recorder: Provided[Recorder], session: Identifier
) -> Session:
    """Stop recording; everything that arrived before is stored when this answers."""
    await run_in_threadpool(catalogue.find, session)
    return await recorder.stop(session)


@router.operation("DELETE /sessions/{session}", Need.OPERATOR, UnknownSessionError, ConflictError)
async def delete_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """Move a session to the bin, until it is purged or `sessions.undo_days` have passed."""
    return await catalogue.delete(session)


@router.operation("POST /sessions/{session}/restore", Need.OPERATOR, UnknownSessionError, ConflictError)
async def restore_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """Take a session out of the bin."""
    return await catalogue.restore(session)


@router.operation("POST /sessions/{session}/purge", Need.OPERATOR, UnknownSessionError, ConflictError)
async def purge_session(
    catalogue: Provided[Catalogue], retention: Provided[RetentionWorker], session: Identifier
) -> None:
    """Remove a session in the bin for good; its disk space is freed little by little."""
    await catalogue.purge(session)
    retention.wake()


@router.operation(
    "GET /sessions/{session}/thumbnail",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    media_type="image/jpeg",
    linked=True,
)
def get_thumbnail(
    _: RecordingTurn,
    request: Request,
    recording: OpenRecording,
    time: Annotated[
        float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False, description="s since the start")
    ],
) -> Response:
    """Return the first small camera picture from this time on.

    With the ETag of an earlier answer in If-None-Match it is 304.
    """
    # A browser asks each time: in another database the number is another session's.
    tag = f'"{recording.row.identifier}-{time!r}"'
    headers = {"cache-control": "private, no-cache", "etag": tag}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    for _moment, jpeg in recording.pictures("thumbnail", recording.row.started_steady + time):
        return Response(jpeg, media_type="image/jpeg", headers=headers)
    raise NotFoundError(f"Session {recording.row.id} has no picture from {time:g} s on.")


@router.operation(
    "POST /sessions/{session}/markers", Need.OPERATOR, NO_BOOKMARK, ConflictError, status_code=201
)
async def add_mark(
    bookmarks: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, body: NewBookmark
) -> Bookmark:
    """Bookmark a moment; without a time it is now.

    Refused beyond the session's end, and without a time after the session has ended.
    """
    mark = await bookmarks.add(session, body.time, body.text)
    catalogue.notify(session)
    return mark


@router.operation("PATCH /sessions/{session}/markers/{mark}", Need.OPERATOR, NO_BOOKMARK, ConflictError)
async def change_mark(
    bookmarks: Provided[Bookmarks], session: Identifier, mark: Identifier, body: BookmarkChanges
) -> Bookmark:
    """Change the time or the text of a bookmark."""
    return await bookmarks.change(session, mark, body.time, body.text)


@router.operation("DELETE /sessions/{session}/markers/{mark}", Need.OPERATOR, NO_BOOKMARK, ConflictError)
async def remove_mark(
    bookmarks: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, mark: Identifier
) -> None:
    """Remove a bookmark for good."""
    await bookmarks.remove(session, mark)
    catalogue.notify(session)


@router.operation("GET /sessions/{session}/timeline", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def get_timeline(_: RecordingTurn, recording: OpenRecording) -> Timeline:
    """Return a session's events, bookmarks and gaps."""
    with reading_content(recording.row):
        return read_timeline(recording)


@router.operation("GET /sessions/{session}/missions", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def list_session_missions(
    _: RecordingTurn, recording: OpenRecording, response: Response
) -> list[RecordedMission]:
    """List the missions of a session: document, last state, and when each step began.

    At most the first hundred: the header `Left-Out` counts the others, which an archive of the session has.
    """
    with reading_content(recording.row):
        missions, left_out = read_missions(recording)
    response.headers[LEFT_OUT] = str(left_out)
    return missions


@router.operation(
    "GET /sessions/{session}/blocks",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    media_type="application/octet-stream",
)
def get_blocks(
    _: RecordingTurn,
    recording: OpenRecording,
    start: Seconds,
    end: Seconds,
    history: Annotated[float | None, Query(ge=0, le=HISTORY_MAX, allow_inf_nan=False)] = None,
) -> Response:
    """Return the samples of all topics from `start` up to `end`, in order of time.

    Times are in s since the session's start; those in the blocks are the stored ones. With a `history` (s)
    the answer begins with the values in force at `start`, and with the earlier samples that the page's charts
    and lists show. The header `Left-Out` counts samples that are damaged or unknown to this version.
    """
    if end < start:
        raise InvalidError(f"The end, {end:g} s, lies before the start, {start:g} s.")
    zero = recording.row.started_steady
    with reading_content(recording.row):
        found = read_blocks_between(recording, zero + start, zero + end, history)
    headers = {LEFT_OUT: str(found.left_out), "Cache-Control": "no-store"}
    return Response(found.data, media_type="application/octet-stream", headers=headers)


@router.operation("GET /storage", Need.VIEWER)
def get_storage(store: Provided[Store], settings: Provided[Settings]) -> Storage:
    """Return the use of the disk that holds the data folder, and the rules of retention."""
    return measure(store, settings)
