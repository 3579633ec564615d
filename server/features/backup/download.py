"""Downloads of the database: one copy at a time, deleted afterwards.

The file of the copy is unlinked before its first byte is sent, so that it is gone however the sending ends.
"""

import asyncio
import os
import shutil
import sqlite3
from collections.abc import Callable
from functools import partial
from typing import BinaryIO

from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from robot_runtime.durable_files import make_folder
from robot_runtime.errors import RefusedError
from server.platform.database_copies import copy_database, new_copy_path, remove_abandoned
from server.platform.disk_space import DIVE_BYTES
from server.platform.errors import InsufficientStorageError
from server.platform.settings import Settings, SetupError
from server.platform.store import Store
from server.platform.user_files import store_files

PIECE_BYTES = 1 << 18


class DatabaseCopyError(InsufficientStorageError):
    """The database cannot be copied"""


class DatabaseDownloads:
    """Copies of a folder's database, made for download."""

    def __init__(self, settings: Settings, store: Store) -> None:
        self._store = store
        self._folder = settings.data
        self._config = settings.config
        self._path = settings.data.backups / "download.db"
        self._busy = False

    def recover(self) -> None:
        """Remove copies, and parts of copies, of killed processes. Raise OSError."""
        self._path.unlink(missing_ok=True)
        if self._folder.backups.is_dir():
            remove_abandoned(self._folder.backups)

    async def begin(self) -> Response:
        """Return an answer that sends the database as it is now.

        Raise RefusedError, DatabaseCopyError, StoreError.
        """
        if self._busy:
            raise RefusedError("A backup is being copied or downloaded already. Wait until it is done.")
        self._busy = True
        try:
            file = await asyncio.to_thread(self._copy)
        except BaseException:
            self._busy = False
            raise
        return FileDownload(file, new_copy_path(self._folder, "backup").name, self._end)

    def _end(self) -> None:
        self._busy = False

    def _copy(self) -> BinaryIO:
        size = self._store.measure().size
        try:
            make_folder(self._path.parent)
            free = shutil.disk_usage(self._path.parent).free
            if free < size + DIVE_BYTES:
                raise DatabaseCopyError(
                    f"There is no room for a copy: {free / 1e6:.0f} MB are free, and the database has "
                    f"{size / 1e6:.0f} MB. Remove sessions or exports; or copy it to another disk, with "
                    "`mucat backup FILE` on the server's computer."
                )
            add = partial(store_files, folder=self._folder, config=self._config)
            copy_database(self._store.location, self._path, add)
            file = self._path.open("rb")
            self._path.unlink()
        except SetupError as problem:
            raise DatabaseCopyError(str(problem)) from problem
        except (OSError, sqlite3.Error) as problem:
            raise DatabaseCopyError(f"The database cannot be copied: {problem}. Check the disk.") from problem
        return file


class FileDownload(StreamingResponse):
    """An answer that sends a file, closes it and calls `ended`; also if the client leaves.

    The connection to a client that has stopped reading ends after `server.http.listener.USER_TIMEOUT_MS`.
    """

    def __init__(self, file: BinaryIO, name: str, ended: Callable[[], None]) -> None:
        headers = {
            "content-length": str(os.fstat(file.fileno()).st_size),
            "content-disposition": f'attachment; filename="{name}"',
            "cache-control": "no-store",
        }
        super().__init__(iter(partial(file.read, PIECE_BYTES), b""), 200, headers, "application/vnd.sqlite3")
        self._file = file
        self._ended = ended

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the file piece by piece."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._file.close()
            self._ended()
