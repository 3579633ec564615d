"""Exports of sessions: start, progress, download; imports of archives."""

from typing import Annotated

from fastapi import Path, Request
from fastapi.concurrency import run_in_threadpool
from starlette.responses import FileResponse

from server.driving.admission import read_admitted
from server.features.exports.archive_reader import ArchiveError
from server.features.exports.formats import KINDS
from server.features.exports.imports import Imports
from server.features.exports.jobs import JOBS_MAX, OPERATORS_ONLY, Jobs, UnknownExportError
from server.features.exports.schemas import Job, NewExport
from server.features.exports.selection import ExportRequestError
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, refusal
from server.http.uploads import InvalidUploadError
from server.platform.disk_space import FileWriteError
from server.platform.errors import ConflictError
from server.platform.store import Store
from server.recording.schemas import Session
from server.recording.session import UnknownSessionError, find_row, from_row

router = Operations(prefix="/api", tags=["exports"])

Identifier = Annotated[str, Path(pattern=r"^[0-9a-f]{16}$")]


@router.operation("GET /exports", Need.VIEWER)
async def list_exports(jobs: Provided[Jobs]) -> list[Job]:
    """List the exports that are stored, running or waiting, newest first."""
    return jobs.list()


@router.operation(
    "POST /exports",
    Need.VIEWER,
    UnknownSessionError,
    ConflictError,
    ExportRequestError,
    FileWriteError,
    status_code=201,
)
async def start_export(store: Provided[Store], jobs: Provided[Jobs], caller: Caller, body: NewExport) -> Job:
    """Export a session to a file, in a process beside the server; GET returns the progress."""
    most = JOBS_MAX - OPERATORS_ONLY if refusal(caller, Need.ARCHIVE) else JOBS_MAX
    return await jobs.add(await run_in_threadpool(find_row, store, body.session), body, most)


@router.operation("GET /exports/{export}", Need.VIEWER, UnknownExportError)
async def get_export(jobs: Provided[Jobs], export: Identifier) -> Job:
    """Return the progress of an export, and its size and checksum when it is done."""
    return jobs.find(export)


@router.operation("DELETE /exports/{export}", Need.ARCHIVE, UnknownExportError, {409: "It cannot be deleted"})
async def delete_export(jobs: Provided[Jobs], export: Identifier) -> None:
    """Cancel an export, or delete its file."""
    jobs.remove(jobs.find(export))


@router.operation(
    "GET /exports/{export}/file",
    Need.VIEWER,
    UnknownExportError,
    {409: "It is not finished"},
    media_type="application/octet-stream",
    linked=True,
)
async def download_export(jobs: Provided[Jobs], export: Identifier) -> FileResponse:
    """Download the file of an export.

    An interrupted download continues with Range, and If-Range with its ETag.
    """
    job = jobs.find(export)
    if job.state != "done":
        raise ConflictError(job.problem or "The file is not finished. Wait until its state is done.")
    return FileResponse(
        jobs.path(job),
        filename=job.file,
        media_type=KINDS[job.wanted.format].media_type,
        headers={"etag": f'"{job.sha256}"'},
    )


@router.operation(
    "POST /imports",
    Need.OPERATOR,
    ArchiveError,
    InvalidUploadError,
    FileWriteError,
    {409: "The session exists, another import is running, or the robot is armed"},
    status_code=201,
    openapi_extra={
        "requestBody": {"required": True, "content": {"application/zip": {"schema": {"type": "string"}}}}
    },
)
async def import_session(
    request: Request, monitor: Provided[HealthMonitor], imports: Provided[Imports], store: Provided[Store]
) -> Session:
    """Import a session from an archive, the request's body; it is stored whole or not at all."""
    monitor.require_disarmed("An upload slows the recording.")
    length = request.headers.get("content-length")
    number = await imports.receive(read_admitted(request), int(length) if length else None)
    return from_row(await run_in_threadpool(find_row, store, number))
