"""Imports sessions of other machines: an archive is received, checked, and stored under a new number.

It is stored piece by piece, so that a recording is not delayed, and stays hidden until its last piece is
stored. The retention worker removes incomplete imports.
"""

import asyncio
import json
import zipfile
from collections.abc import AsyncIterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from secrets import token_hex
from typing import Any

from sqlalchemy import insert, update
from sqlmodel import SQLModel, col, select

from robot_runtime.durable_files import PART, make_folder
from robot_runtime.errors import RefusedError
from server.features.exports.archive_reader import ROWS_AT_ONCE, ArchiveChunks, ArchiveError, open_archive
from server.features.exports.export_process import ExportProcess, ExportProcessError
from server.http.uploads import save_upload
from server.library.intake import ArchiveIntake
from server.platform.disk_space import FileWriteError, explain_write_error, require_free
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag
from server.platform.settings import DataFolder
from server.platform.store import Store, insert_row
from server.recording.session import IMPORTING, REMOVING

BATCH_BYTES = 500_000
"""Stored in one transaction."""
UPLOADS_MAX = 4
TABLES: Mapping[str, type[SQLModel]] = {"tags": SessionTag, "markers": BookmarkRow, "gaps": Gap}
COPIES = 2
"""During an import a session is on the disk twice: as the archive and in the database."""


class Imports(ArchiveIntake):
    """The imports of a server, one at a time."""

    def __init__(self, folder: DataFolder, store: Store) -> None:
        self._folder = folder.imports
        self._data = folder.path
        self._store = store
        self._busy = asyncio.Lock()
        self._uploads = 0

    async def recover(self) -> None:
        """Remove unfinished imports of a killed server. Raise StoreError."""
        if self._folder.is_dir():
            for file in self._folder.iterdir():
                file.unlink(missing_ok=True)
        await self._drop_unfinished()

    async def receive(self, pieces: AsyncIterable[bytes], size: int | None) -> int:
        """Import the archive that arrives in pieces, of `size` bytes if known; return the session's number.

        Raise RefusedError if it cannot be imported now, InvalidUploadError, ArchiveError, StoreError, and
        FileWriteError if the disk fails.
        """
        if self._uploads >= UPLOADS_MAX:
            raise RefusedError(f"{UPLOADS_MAX} archives are being uploaded. Wait for the end of one.")
        require_free(self._data, COPIES * (size or 0))
        path = self._folder / (token_hex(8) + PART)
        self._uploads += 1
        try:
            await save_upload(pieces, path)
        finally:
            self._uploads -= 1
        try:
            if self._busy.locked():
                raise RefusedError("Another archive is being imported. Wait for its end.")
            async with self._busy:
                return await self._take(path)
        finally:
            await asyncio.to_thread(path.unlink, missing_ok=True)

    async def take(self, path: Path) -> int:
        """Import the archive in a file. Raise as `receive`."""
        async with self._busy:
            require_free(self._data, path.stat().st_size)
            return await self._take(path)

    async def take_merged(self, path: Path) -> int:
        """Import the archive in a file as a lab keeps it. Raise as `receive`."""
        async with self._busy:
            require_free(self._data, COPIES * path.stat().st_size)
            merged = self._folder / (token_hex(8) + PART)
            try:
                return await self._take(path, merged)
            finally:
                await asyncio.to_thread(merged.unlink, missing_ok=True)

    async def drop_unfinished(self) -> None:
        """Have the rest of imports that broke off removed. Raise StoreError."""
        async with self._busy:
            await self._drop_unfinished()

    async def _take(self, path: Path, merged: Path | None = None) -> int:
        # The process that checks it gives way to all others: on a busy computer it needs a minute to begin.
        if not await asyncio.to_thread(zipfile.is_zipfile, path):
            raise ArchiveError("The archive cannot be imported. It is no zip file, or it is cut off.")
        rows = self._folder / (token_hex(8) + PART)
        try:
            await asyncio.to_thread(make_folder, self._folder)
            files = [path, rows] if merged is None else [path, rows, merged]
            try:
                await ExportProcess(["examine", *map(str, files)], lambda _: None).run()
            except ExportProcessError as problem:
                raise ArchiveError(f"The archive cannot be imported. {problem}") from problem
            if merged is None:
                return await self._store_session(path, rows, origin="import")
            return await self._store_session(merged, rows)
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, rows)) from problem
        finally:
            await asyncio.to_thread(rows.unlink, missing_ok=True)

    async def _store_session(self, path: Path, rows: Path, **changes: str) -> int:
        # An import whose end could not even be marked is one of these: they are one at a time.
        await self._drop_unfinished()
        lines = _read_lines(rows)
        first = await asyncio.to_thread(next, lines)
        session: dict[str, Any] = first["session"]
        await asyncio.to_thread(self._refuse_known, session["identifier"])
        values = session | changes
        values |= {"state": IMPORTING, "samples": 0, "bytes": 0, "kept": False}
        number = await self._store.write(lambda connection: insert_row(connection, SessionRow, values))
        try:
            await self._fill(number, lines)
            done = await self._fill_chunks(number, path)
            await self._change(number, {"state": session["state"], **done})
        except BaseException:
            # The retention worker removes the rest.
            await asyncio.shield(self._drop_unfinished())
            raise
        return number

    async def _drop_unfinished(self) -> None:
        """Mark unfinished imports for removal. Raise StoreError."""
        unfinished = update(SessionRow).where(col(SessionRow.state) == IMPORTING).values(state=REMOVING)
        await self._store.write(lambda connection: connection.execute(unfinished), frees=True)

    def _refuse_known(self, identifier: str) -> None:
        with self._store.read() as database:
            row = database.exec(select(SessionRow).where(SessionRow.identifier == identifier)).first()
        if row is None:
            return
        if row.state == REMOVING:
            raise RefusedError("This session was here and is being removed. Try again in a few minutes.")
        binned = " It is in the bin; restore it there." if row.deleted is not None else ""
        raise RefusedError(f"This session is here already, as number {row.id}: “{row.name}”.{binned}")

    async def _fill(self, number: int, lines: Iterator[dict[str, Any]]) -> None:
        while line := await asyncio.to_thread(next, lines, None):
            for name, rows in line.items():
                owned = [{"session_id": number, **row} for row in rows]
                await self._store.execute(insert(TABLES[name]), owned)

    async def _fill_chunks(self, number: int, path: Path) -> dict[str, int]:
        """Store the chunks; return the number of samples and of bytes."""
        batches = _batches(path, number)
        samples = size = 0
        while batch := await asyncio.to_thread(next, batches, None):
            await self._store.execute(insert(Chunk), batch)
            samples += sum(row["count"] for row in batch)
            size += sum(len(row["data"]) for row in batch)
        return {"samples": samples, "bytes": size}

    async def _change(self, number: int, values: dict[str, Any]) -> None:
        await self._store.execute(update(SessionRow).where(col(SessionRow.id) == number).values(values))


def _read_lines(rows: Path) -> Iterator[dict[str, Any]]:
    with rows.open(encoding="utf-8") as file:
        yield from map(json.loads, file)


def _batches(path: Path, number: int) -> Iterator[list[dict[str, Any]]]:
    batch: list[dict[str, Any]] = []
    size = 0
    with open_archive(path, ArchiveChunks) as archive:
        for topic in archive.topics:
            for chunk in archive.chunks(topic):
                batch.append({**asdict(chunk), "topic": topic, "session_id": number})
                size += len(chunk.data)
                if size >= BATCH_BYTES or len(batch) >= ROWS_AT_ONCE:
                    yield batch
                    batch, size = [], 0
    if batch:
        yield batch
