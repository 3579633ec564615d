"""Sessions: start, stop, list, download."""

import json
from typing import Annotated

from fastapi import APIRouter, HTTPException, Path, Request
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import StreamingResponse

from server.assembly import Assembly
from server.exports.describe import file_name
from server.exports.shapes import Wanted
from server.exports.source import Source
from server.exports.tables import stream_tables
from server.models import SessionRow
from server.recorder import RecordingRefused
from server.routes.problems import answers
from server.sessions import IDENTIFIER_MAX, Session, find_row, from_row, list_sessions, new_row

UNKNOWN = answers(_404="There is no such session")
STORING = answers(_409="Refused now", _503="The database does not work")

router = APIRouter(prefix="/api/sessions", tags=["sessions"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


class NewSession(BaseModel):
    """A session that is to begin; without a name it is called after its moment."""

    model_config = ConfigDict(extra="forbid")
    name: Annotated[str, Field(max_length=100)] = ""
    note: Annotated[str, Field(max_length=10_000)] = ""


@router.get("", summary="All sessions, newest first", operation_id="listSessions")
def get_sessions(request: Request) -> list[Session]:
    """All sessions."""
    return list_sessions(Assembly.of(request).store)


@router.post("", status_code=201, summary="Start recording", operation_id="startSession", responses=STORING)
async def start_session(request: Request, wanted: NewSession) -> Session:
    """Record everything from now on; refused while another records, or the board is lent to a test."""
    assembly = Assembly.of(request)
    if assembly.bridge.lent is not None:
        raise RecordingRefused(assembly.bridge.lent)
    state = json.dumps(assembly.watch.state())
    try:
        row = new_row(assembly.settings, assembly.clock, wanted.name.strip(), wanted.note.strip(), state)
    except OSError as problem:
        raise RecordingRefused(
            f"The configuration {assembly.settings.config} cannot be read: {problem}"
        ) from problem
    return await assembly.recorder.start(row)


@router.get("/{session}", summary="One session", operation_id="getSession", responses=UNKNOWN)
def get_session(request: Request, session: Identifier) -> Session:
    """One session."""
    return from_row(_find(request, session))


@router.post(
    "/{session}/stop", summary="Stop recording", operation_id="stopSession", responses={**UNKNOWN, **STORING}
)
async def stop_session(request: Request, session: Identifier) -> Session:
    """Stop recording; everything that arrived before is stored when this answers."""
    await run_in_threadpool(_find, request, session)
    return await Assembly.of(request).recorder.stop(session)


@router.get(
    "/{session}/csv",
    summary="Download a session",
    operation_id="downloadSession",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/zip": {}}, "description": "A zip file"}, **UNKNOWN},
)
def get_csv(request: Request, session: Identifier) -> StreamingResponse:
    """One CSV file for each topic, with units in its header, and `session.json` with everything else."""
    store = Assembly.of(request).store
    source = Source(store, _find(request, session), Wanted(format="csv"))
    headers = {"content-disposition": f'attachment; filename="{file_name(source, ".zip")}"'}
    return StreamingResponse(stream_tables(store, source), media_type="application/zip", headers=headers)


def _find(request: Request, session: int) -> SessionRow:
    row = find_row(Assembly.of(request).store, session)
    if row is None:
        raise HTTPException(404, f"There is no session {session}; GET /api/sessions lists those there are.")
    return row
