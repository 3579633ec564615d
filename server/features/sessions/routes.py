"""Sessions: start, stop, find, describe, delete, download."""

import json
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, ConfigDict
from starlette.responses import Response

from robot_runtime.clock import Clock
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.dependencies import STORING, UNKNOWN, Identifier, OpenRecording
from server.features.sessions.recorder import Recorder, RecordingRefusedError
from server.features.sessions.retention import Tidying
from server.features.sessions.session import (
    Name,
    Note,
    Origin,
    Session,
    SessionChanges,
    SessionDetail,
    new_row,
)
from server.health.monitor import Watch
from server.http.dependencies import Provided
from server.http.sign_in.policy import Need, needs
from server.platform.errors import NotFoundError
from server.platform.settings import Settings
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/sessions", tags=["sessions"])


class NewSession(BaseModel):
    """A session that is to begin; without a name it is called after its moment."""

    model_config = ConfigDict(extra="forbid")
    name: Name = ""
    note: Note = ""


@router.get(
    "", summary="Sessions, newest first", operation_id="listSessions", openapi_extra=needs(Need.VIEWER)
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
    "",
    status_code=201,
    summary="Start recording",
    operation_id="startSession",
    openapi_extra=needs(Need.OPERATOR),
    responses=STORING,
)
async def start_session(
    bridge: Provided[Bridge],
    watch: Provided[Watch],
    settings: Provided[Settings],
    clock: Provided[Clock],
    recorder: Provided[Recorder],
    wanted: NewSession,
) -> Session:
    """Record everything from now on; refused while another records, or the board is lent to a test."""
    if bridge.lent is not None:
        raise RecordingRefusedError(bridge.lent)
    state = json.dumps(watch.state())
    try:
        row = await run_in_threadpool(new_row, settings, clock, wanted.name, wanted.note, state)
    except OSError as problem:
        raise RecordingRefusedError(
            f"The configuration {settings.config} cannot be read: {problem}"
        ) from problem
    return await recorder.start(row)


@router.get(
    "/{session}",
    summary="One session",
    operation_id="getSession",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
def get_session(catalogue: Provided[Catalogue], session: Identifier) -> SessionDetail:
    """One session with everything that is known of it, but its samples; also from the bin."""
    return catalogue.detail(session)


@router.patch(
    "/{session}",
    summary="Name, note, tag or keep a session",
    operation_id="changeSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def change_session(
    catalogue: Provided[Catalogue], session: Identifier, wanted: SessionChanges
) -> Session:
    """Change what people say about it; tags are replaced as a whole."""
    return await catalogue.change(session, **wanted.model_dump())


@router.post(
    "/{session}/stop",
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
    "/{session}",
    summary="Put a session into the bin",
    operation_id="deleteSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def delete_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """It can be restored until it is purged, or until `sessions.undo_days` have passed."""
    return await catalogue.delete(session)


@router.post(
    "/{session}/restore",
    summary="Take a session out of the bin",
    operation_id="restoreSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def restore_session(catalogue: Provided[Catalogue], session: Identifier) -> Session:
    """Undo its deletion."""
    return await catalogue.restore(session)


@router.post(
    "/{session}/purge",
    status_code=204,
    summary="Remove a session that is in the bin for good",
    operation_id="purgeSession",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def purge_session(
    catalogue: Provided[Catalogue], tidying: Provided[Tidying], session: Identifier
) -> None:
    """It is gone at once; the room that it took comes back little by little."""
    await catalogue.purge(session)
    tidying.wake()


@router.get(
    "/{session}/thumbnail",
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
