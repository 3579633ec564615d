"""A copy of the database for somebody who asks for it over the network: one at a time, and nothing stays.

The copy has no name any more when its first byte is sent, so that it is gone however the sending ends.
"""

import asyncio
import shutil
import sqlite3
from collections.abc import Callable
from typing import BinaryIO

from starlette.requests import Request
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from robot_runtime.durable_files import PART, make_folder
from robot_runtime.errors import RefusedError
from server.platform.database_copies import copy_database, place
from server.platform.disk_space import DIVE_BYTES
from server.platform.errors import InsufficientStorageError
from server.platform.settings import DataFolder

PIECE_BYTES = 1 << 18
STALLED_SECONDS = 60.0
"""For which a piece may wait for whoever downloads; then the download is broken off."""


class DatabaseCopyError(InsufficientStorageError):
    """It cannot be copied"""


class Downloads:
    """Makes copies of this folder's database to be sent."""

    def __init__(self, folder: DataFolder) -> None:
        self._folder = folder
        self._path = folder.backups / "download.db"
        self._busy = False

    def recover(self) -> None:
        """Remove what a server that was killed has left. Raises OSError."""
        for path in (self._path, self._path.with_name(self._path.name + PART)):
            path.unlink(missing_ok=True)

    async def begin(self, request: Request) -> Response:
        """An answer that sends the database as it is now. Raises RefusedError, DatabaseCopyError."""
        if self._busy:
            raise RefusedError("A backup is being copied or downloaded already. Wait until it is done.")
        self._busy = True
        try:
            file = await asyncio.to_thread(self._copy)
        except BaseException:
            self._busy = False
            raise
        return Download(request, file, place(self._folder, "backup").name, self._end)

    def _end(self) -> None:
        self._busy = False

    def _copy(self) -> BinaryIO:
        database = self._folder.database
        try:
            make_folder(self._path.parent)
            free, size = shutil.disk_usage(self._path.parent).free, database.stat().st_size
            if free < size + DIVE_BYTES:
                raise DatabaseCopyError(
                    f"There is no room for a copy: {free / 1e6:.0f} MB are free, and the database has "
                    f"{size / 1e6:.0f} MB. Remove sessions or exports; or copy it to another disk, with "
                    "`mucat backup FILE` on the robot's computer."
                )
            copy_database(database, self._path)
            file = self._path.open("rb")
            self._path.unlink()
        except (OSError, sqlite3.Error) as problem:
            raise DatabaseCopyError(
                f"The database cannot be copied: {problem}. Look at the disk."
            ) from problem
        return file


class Download(Response):
    """Sends a file to its end and closes it; `ended` is called then, or when it is broken off."""

    def __init__(self, request: Request, file: BinaryIO, name: str, ended: Callable[[], None]) -> None:
        size = file.seek(0, 2)
        file.seek(0)
        headers = {
            "content-length": str(size),
            "content-disposition": f'attachment; filename="{name}"',
            "cache-control": "no-store",
        }
        super().__init__(None, headers=headers, media_type="application/vnd.sqlite3")
        self._request = request
        self._file = file
        self._ended = ended

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002
        """Send piece by piece; one that nobody takes ends it, and the connection with it."""
        try:
            start = {"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers}
            await send(start)
            more = True
            while more and not await self._request.is_disconnected():
                piece = await asyncio.to_thread(self._file.read, PIECE_BYTES)
                more = piece != b""
                async with asyncio.timeout(STALLED_SECONDS):
                    await send({"type": "http.response.body", "body": piece, "more_body": more})
        finally:
            self._file.close()
            self._ended()
