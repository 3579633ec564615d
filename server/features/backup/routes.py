"""Download of the database."""

from starlette.responses import Response

from server.features.backup.download import DatabaseCopyError, DatabaseDownloads
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/backup", tags=["sessions"])


BUSY = {409: "Another copy is being made or downloaded"}


@router.operation("GET", Need.ADMINISTER, DatabaseCopyError, BUSY, media_type="application/vnd.sqlite3")
async def download_backup(downloads: Provided[DatabaseDownloads]) -> Response:
    """Download a copy of the database.

    It holds sessions, tests, tuning and devices as they are at one moment; recording goes on. `mucat restore`
    puts it back.
    """
    return await downloads.begin()
