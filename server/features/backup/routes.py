"""The whole database, to be taken home."""

from fastapi import APIRouter
from starlette.responses import Response

from server.features.backup.download import DatabaseCopyError, Downloads
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs

router = APIRouter(prefix="/api/backup", tags=["sessions"])


@router.get(
    "",
    summary="Download a copy of the database",
    operation_id="downloadBackup",
    openapi_extra=needs(Need.OPERATOR),
    response_class=Response,
    responses={
        200: {
            "content": {"application/vnd.sqlite3": {}},
            "description": "The database at one moment; `mucat restore` puts it back",
        },
        **answers(DatabaseCopyError, _409="Another one is being copied or downloaded"),
    },
)
async def download_backup(downloads: Provided[Downloads]) -> Response:
    """Sessions, tests, what was tuned and who may come in. Recording goes on meanwhile."""
    return await downloads.begin()
