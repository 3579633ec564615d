"""Sessions: search, description, replay, and the storage that they take."""

from typing import Annotated
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from fastapi import Query, Request
from fastapi.responses import Response

from server.http.dependencies import Provided
from server.http.heavy_requests import RecordingTurn, TooManyHeavyError
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.library.catalogue import Catalogue
from server.library.content import reading_content
from server.library.film import CodecMissingError, small_picture
from server.library.listing import GroupsQuery, ListQuery
from server.library.missions import RecordedMission, read_missions
from server.library.opening import SECONDS_MAX, Moment, OpenRecording
from server.library.replay import HISTORY_MAX, read_blocks_between
from server.library.retention import RetentionWorker
from server.library.schemas import (
    ArchivedSessions,
    SessionChanges,
    SessionDetail,
    SessionEdits,
    SessionGroup,
)
from server.library.storage import Storage, measure
from server.library.timeline import Timeline, read_timeline
from server.platform.errors import ConflictError, InvalidError, NotFoundError
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.schemas import Session, SessionNumber
from server.recording.session import UnknownSessionError

LEFT_OUT = "Left-Out"
"""The header that says how many samples, or missions, are not in the answer."""
TOTAL_COUNT = "Total-Count"
"""The header that says how many sessions match."""

router = Operations(prefix="/api", tags=["sessions"])

Seconds = Annotated[float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False)]


@router.operation("GET /sessions", Need.VIEWER)
def list_sessions(
    catalogue: Provided[Catalogue],
    request: Request,
    response: Response,
    query: Annotated[ListQuery, Query()],
) -> list[Session]:
    """List the sessions that match every given condition, newest first, a page at a time.

    Grouped `by` something, the groups follow each other, those without it last. The header `Total-Count`
    counts all matches. Where more follow, the header `Link` has the next page's address (`rel="next"`).
    """
    page = catalogue.page(query, by=query.by, before=query.before, skip=query.skip, limit=query.limit)
    response.headers[TOTAL_COUNT] = str(page.total)
    if page.following is not None:
        # New sessions move the others down, so that a list by numbers goes on by numbers.
        step = (
            {"before": page.following} if query.by in ("none", "day") else {"skip": query.skip + query.limit}
        )
        following = request.url.include_query_params(**step)
        if "before" in step:
            following = following.remove_query_params("skip")
        response.headers["Link"] = f'<{following.path}?{following.query}>; rel="next"'
    return page.sessions


@router.operation("GET /sessions/groups", Need.VIEWER)
def list_session_groups(
    catalogue: Provided[Catalogue], query: Annotated[GroupsQuery, Query()]
) -> list[SessionGroup]:
    """List the groups of the sessions that match, in the order of the list."""
    try:
        zone = ZoneInfo(query.zone)
    except (ZoneInfoNotFoundError, ValueError, OSError) as problem:
        raise InvalidError(
            f"This computer knows no time zone “{query.zone}”. Name one such as Europe/Tallinn, or UTC."
        ) from problem
    return catalogue.groups(query, query.by, zone)


@router.operation("GET /sessions/controllers", Need.VIEWER)
def list_session_controllers(catalogue: Provided[Catalogue]) -> list[str]:
    """List the titles of the controllers that held the depth in some session; at most a hundred."""
    return catalogue.controllers()


@router.operation("GET /sessions/robots", Need.VIEWER)
def list_session_robots(catalogue: Provided[Catalogue]) -> list[str]:
    """List the names of the robots that recorded some session; at most a hundred."""
    return catalogue.robots()


@router.operation("GET /sessions/edits", Need.VIEWER)
def list_session_edits(
    catalogue: Provided[Catalogue], before: Annotated[SessionNumber | None, Query()] = None
) -> list[SessionEdits]:
    """List the sessions that have ended, newest first, with the number of their edits; for a lab's archive.

    At most a thousand; with `before` only those of lower numbers.
    """
    return catalogue.edits(before)


@router.operation("GET /tags", Need.VIEWER)
def list_tags(catalogue: Provided[Catalogue]) -> list[str]:
    """List the tags of the sessions, those of most sessions first; at most a hundred."""
    return catalogue.tags()


@router.operation("GET /sessions/{session}", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def get_session(_: RecordingTurn, catalogue: Provided[Catalogue], session: Identifier) -> SessionDetail:
    """Return a session with all data except its samples; also from the bin.

    Long lists are cut off: `markers` and `gap_count` count all, and an archive of the session has all.
    """
    return catalogue.detail(session)


@router.operation("PATCH /sessions/{session}", Need.OPERATOR, UnknownSessionError, ConflictError)
async def change_session(
    catalogue: Provided[Catalogue], session: Identifier, body: SessionChanges
) -> Session:
    """Change name, note, tags or protection of a session; tags are replaced as a whole."""
    return await catalogue.change(session, **body.model_dump())


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
    CodecMissingError,
    TooManyHeavyError,
    media_type="image/jpeg",
    linked=True,
)
def get_thumbnail(
    _: RecordingTurn,
    request: Request,
    recording: OpenRecording,
    time: Moment,
) -> Response:
    """Return the first small camera picture from this time on.

    Of a session without such pictures it is made of the film: of the key picture before that time. With the
    ETag of an earlier answer in If-None-Match it is 304.
    """
    # A browser asks each time: in another database the number is another session's.
    tag = f'"{recording.row.identifier}-{time!r}"'
    headers = {"cache-control": "private, no-cache", "etag": tag}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    steady = recording.row.started_steady + time
    with reading_content(recording.row):
        jpeg = small_picture(recording, steady)
    if jpeg is None:
        raise NotFoundError(f"Session {recording.row.id} has no picture from {time:g} s on.")
    return Response(jpeg, media_type="image/jpeg", headers=headers)


@router.operation("GET /sessions/{session}/timeline", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def get_timeline(_: RecordingTurn, recording: OpenRecording) -> Timeline:
    """Return a session's events, bookmarks and gaps."""
    with reading_content(recording.row):
        return read_timeline(recording)


@router.operation("GET /sessions/{session}/missions", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def list_session_missions(
    _: RecordingTurn, recording: OpenRecording, response: Response
) -> list[RecordedMission]:
    """List the missions of a session: document, last state, and the start of each step.

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
        blocks = read_blocks_between(recording, zero + start, zero + end, history)
    headers = {LEFT_OUT: str(blocks.left_out), "Cache-Control": "no-store"}
    return Response(blocks.data, media_type="application/octet-stream", headers=headers)


@router.operation("POST /sessions/archived", Need.ARCHIVE)
async def note_archived(catalogue: Provided[Catalogue], body: ArchivedSessions) -> None:
    """Note that a lab has these sessions: where the disk is short of space, they go first.

    Sessions that are not here are passed over.
    """
    await catalogue.note_archived(body.identifiers)


@router.operation("GET /storage", Need.VIEWER)
def get_storage(store: Provided[Store], settings: Provided[Settings]) -> Storage:
    """Return the use of the disk that holds the data folder, and the rules of retention."""
    return measure(store, settings)
