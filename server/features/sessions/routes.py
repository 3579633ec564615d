"""Sessions: start, stop, find, describe, delete, download."""

import json
from typing import Annotated

from fastapi import APIRouter, HTTPException, Path, Query, Request
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, ConfigDict
from starlette.responses import Response, StreamingResponse

from server.container import Assembly
from server.features.exports.description import file_name
from server.features.exports.schemas import Wanted
from server.features.exports.selection import Source
from server.features.exports.tables import stream_tables
from server.features.sessions.recorder import RecordingRefused
from server.features.sessions.recording import Recording
from server.features.sessions.session import (
    Name,
    Note,
    Origin,
    Session,
    SessionChanges,
    SessionDetail,
    new_row,
)
from server.http.problems import answers
from server.platform.models import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such session")
STORING = answers(_409="Refused now", _503="The database does not work")

router = APIRouter(prefix="/api/sessions", tags=["sessions"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


class NewSession(BaseModel):
    """A session that is to begin; without a name it is called after its moment."""

    model_config = ConfigDict(extra="forbid")
    name: Name = ""
    note: Note = ""


@router.get("", summary="Sessions, newest first", operation_id="listSessions")
def get_sessions(
    request: Request,
    search: Annotated[
        str, Query(max_length=200, description="words that name, note, tags or scenario have")
    ] = "",
    tag: Annotated[list[str] | None, Query(description="tags that they have, all of them")] = None,
    origin: Origin | None = None,
    deleted: Annotated[bool, Query(description="those in the bin instead")] = False,
) -> list[Session]:
    """Sessions that are to be found by all that is asked."""
    return Assembly.of(request).catalogue.list(search, tag or (), origin, deleted=deleted)


@router.post("", status_code=201, summary="Start recording", operation_id="startSession", responses=STORING)
async def start_session(request: Request, wanted: NewSession) -> Session:
    """Record everything from now on; refused while another records, or the board is lent to a test."""
    assembly = Assembly.of(request)
    if assembly.bridge.lent is not None:
        raise RecordingRefused(assembly.bridge.lent)
    state = json.dumps(assembly.watch.state())
    try:
        row = await run_in_threadpool(
            new_row, assembly.settings, assembly.clock, wanted.name, wanted.note, state
        )
    except OSError as problem:
        raise RecordingRefused(
            f"The configuration {assembly.settings.config} cannot be read: {problem}"
        ) from problem
    return await assembly.recorder.start(row)


@router.get("/{session}", summary="One session", operation_id="getSession", responses=UNKNOWN)
def get_session(request: Request, session: Identifier) -> SessionDetail:
    """One session with everything that is known of it, but its samples; also from the bin."""
    return Assembly.of(request).catalogue.detail(session)


@router.patch(
    "/{session}",
    summary="Name, note, tag or keep a session",
    operation_id="changeSession",
    responses={**UNKNOWN, **STORING},
)
async def change_session(request: Request, session: Identifier, wanted: SessionChanges) -> Session:
    """Change what people say about it; tags are replaced as a whole."""
    return await Assembly.of(request).catalogue.change(session, **wanted.model_dump())


@router.post(
    "/{session}/stop", summary="Stop recording", operation_id="stopSession", responses={**UNKNOWN, **STORING}
)
async def stop_session(request: Request, session: Identifier) -> Session:
    """Stop recording; everything that arrived before is stored when this answers."""
    assembly = Assembly.of(request)
    await run_in_threadpool(assembly.catalogue.find, session)
    return await assembly.recorder.stop(session)


@router.delete(
    "/{session}",
    summary="Put a session into the bin",
    operation_id="deleteSession",
    responses={**UNKNOWN, **STORING},
)
async def delete_session(request: Request, session: Identifier) -> Session:
    """It can be restored until it is purged, or until `sessions.undo_days` have passed."""
    return await Assembly.of(request).catalogue.delete(session)


@router.post(
    "/{session}/restore",
    summary="Take a session out of the bin",
    operation_id="restoreSession",
    responses={**UNKNOWN, **STORING},
)
async def restore_session(request: Request, session: Identifier) -> Session:
    """Undo its deletion."""
    return await Assembly.of(request).catalogue.restore(session)


@router.post(
    "/{session}/purge",
    status_code=204,
    summary="Remove a session that is in the bin for good",
    operation_id="purgeSession",
    responses={**UNKNOWN, **STORING},
)
async def purge_session(request: Request, session: Identifier) -> None:
    """It is gone at once; the room that it took comes back little by little."""
    assembly = Assembly.of(request)
    await assembly.catalogue.purge(session)
    assembly.tidying.wake()


@router.get(
    "/{session}/thumbnail",
    summary="A small picture of what the camera saw",
    operation_id="getThumbnail",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "The picture"}, **UNKNOWN},
)
def get_thumbnail(
    request: Request, session: Identifier, time: Annotated[float, Query(description="s since the start")]
) -> Response:
    """The first from this time on."""
    assembly = Assembly.of(request)
    row = assembly.catalogue.row(session)
    recording = Recording(assembly.store, row)
    for _, jpeg in recording.pictures("thumbnail", row.started_steady + time):
        return Response(jpeg, media_type="image/jpeg", headers={"cache-control": "max-age=86400"})
    raise HTTPException(404, f"Session {session} has no picture from {time:g} s on.")


@router.get(
    "/{session}/csv",
    summary="Download a session",
    operation_id="downloadSession",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/zip": {}}, "description": "A zip file"}, **UNKNOWN},
)
def get_csv(request: Request, session: Identifier) -> StreamingResponse:
    """One CSV file for each topic, with units in its header, and `session.json` with everything else."""
    assembly = Assembly.of(request)
    source = Source(assembly.store, assembly.catalogue.row(session), Wanted(format="csv"))
    headers = {"content-disposition": f'attachment; filename="{file_name(source, ".zip")}"'}
    return StreamingResponse(
        stream_tables(assembly.store, source), media_type="application/zip", headers=headers
    )
