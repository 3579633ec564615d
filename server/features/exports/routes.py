"""Exports: have a file made, look how far it is, download it; imports of archives."""

from typing import Annotated

from fastapi import APIRouter, Path, Request
from fastapi.concurrency import run_in_threadpool
from starlette.responses import FileResponse

from server.features.exports.archive_reader import ArchiveError
from server.features.exports.files import FileWriteError
from server.features.exports.formats import KINDS
from server.features.exports.imports import Imports
from server.features.exports.jobs import Jobs
from server.features.exports.schemas import Job, NewExport
from server.features.exports.selection import ExportRequestError
from server.features.sessions.schemas import Session
from server.features.sessions.session import UnknownSessionError, find_row, from_row
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.errors import ConflictError, NotFoundError
from server.platform.store import Store, StoreError

UNKNOWN = answers(_404="There is no such export")

router = APIRouter(prefix="/api", tags=["exports"])

Identifier = Annotated[str, Path(pattern=r"^[0-9a-f]{16}$")]


@router.get(
    "/exports",
    summary="All exports, newest first",
    operation_id="listExports",
    openapi_extra=needs(Need.VIEWER),
)
async def get_exports(jobs: Provided[Jobs]) -> list[Job]:
    """Those that are kept, and those that are being made."""
    return jobs.list()


@router.post(
    "/exports",
    status_code=201,
    summary="Have a session made into a file",
    operation_id="startExport",
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(UnknownSessionError, ConflictError, ExportRequestError),
)
async def start_export(store: Provided[Store], jobs: Provided[Jobs], body: NewExport) -> Job:
    """Files are made one after the other, apart from the server; GET tells how far it is."""
    row = await run_in_threadpool(find_row, store, body.session)
    if row is None:
        raise NotFoundError(f"There is no session {body.session}; GET /api/sessions lists those there are.")
    return jobs.add(row, body)


@router.get(
    "/exports/{export}",
    summary="One export",
    operation_id="getExport",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
async def get_export(jobs: Provided[Jobs], export: Identifier) -> Job:
    """Progress of an export; its size and checksum when it is done."""
    return _find(jobs, export)


@router.delete(
    "/exports/{export}",
    status_code=204,
    summary="Cancel or delete an export",
    operation_id="deleteExport",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **answers(_409="It cannot be deleted")},
)
async def delete_export(jobs: Provided[Jobs], export: Identifier) -> None:
    """The file is gone then."""
    jobs.remove(_find(jobs, export))


@router.get(
    "/exports/{export}/file",
    summary="Download an export",
    operation_id="downloadExport",
    openapi_extra=needs(Need.VIEWER),
    response_class=FileResponse,
    responses={
        200: {
            "content": {"application/octet-stream": {}},
            "description": "The file; its ETag is its SHA-256",
        },
        206: {"description": "The part that was asked for with Range"},
        **UNKNOWN,
        **answers(_409="It is not finished"),
    },
)
async def get_file(jobs: Provided[Jobs], export: Identifier) -> FileResponse:
    """A download that was cut goes on where it was: ask with Range, and with If-Range its ETag."""
    job = _find(jobs, export)
    if job.state != "done":
        raise ConflictError(job.problem or "The file is not finished yet. Wait until its state is done.")
    return FileResponse(
        jobs.path(job),
        filename=job.file,
        media_type=KINDS[job.wanted.format].media_type,
        headers={"etag": f'"{job.sha256}"'},
    )


@router.post(
    "/imports",
    status_code=201,
    summary="Import the archive of a session",
    operation_id="importSession",
    openapi_extra={
        **needs(Need.OPERATOR),
        "requestBody": {"required": True, "content": {"application/zip": {"schema": {"type": "string"}}}},
    },
    responses=answers(
        ArchiveError,
        StoreError,
        FileWriteError,
        _409="It is here already, another is being imported, or the robot is armed",
    ),
)
async def import_session(
    request: Request, watch: Provided[HealthMonitor], imports: Provided[Imports], store: Provided[Store]
) -> Session:
    """The body is the file. It is looked at as a whole, and stored as a whole or not at all."""
    watch.require_disarmed("An upload takes time and disk from what is recorded.")
    length = request.headers.get("content-length")
    number = await imports.receive(request.stream(), int(length) if length else None)
    row = await run_in_threadpool(find_row, store, number)
    assert row is not None
    return from_row(row)


def _find(jobs: Jobs, export: str) -> Job:
    found = jobs.find(export)
    if found is None:
        raise NotFoundError(f"There is no export {export}; GET /api/exports lists those there are.")
    return found
