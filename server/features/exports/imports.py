"""Imports sessions of other machines: an archive is received, checked, and stored under a new number.

It is stored piece by piece, so that a recording is not delayed, and stays hidden until its last piece is
stored. The retention worker removes what does not become whole.
"""

import asyncio
import json
import shutil
from collections.abc import AsyncIterable, Iterator
from itertools import chain
from pathlib import Path
from secrets import token_hex
from typing import Any

from sqlalchemy import insert, update
from sqlmodel import SQLModel, col, select

from robot_runtime.durable_files import PART
from robot_runtime.errors import RefusedError
from server.features.exports.archive_reader import Archive, ArchiveError, open_archive
from server.features.exports.export_process import ExportProcess, ExportProcessError
from server.features.exports.files import FileWriteError
from server.features.sessions.session import IMPORTING, REMOVING
from server.platform.disk_space import explain_write_error
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag
from server.platform.settings import DataFolder
from server.platform.store import Store, insert_row

BATCH_BYTES = 500_000
"""Stored in one transaction."""
ROWS_AT_ONCE = 2_000
PIECE_BYTES = 1 << 20
SPARE_BYTES = 50_000_000
"""Disk space that is left free for recordings."""
COPIES = 2
"""During an import a session is on the disk twice: as the archive and in the database."""


class Imports:
    """The imports of a server, one at a time."""

    def __init__(self, folder: DataFolder, store: Store) -> None:
        self._folder = folder.imports
        self._data = folder.path
        self._store = store
        self._busy = asyncio.Lock()

    async def recover(self) -> None:
        """Remove unfinished imports of a server that was killed. Raises StoreError."""
        if self._folder.is_dir():
            for file in self._folder.iterdir():
                file.unlink(missing_ok=True)
        unfinished = col(SessionRow.state) == IMPORTING
        await self._store.execute(update(SessionRow).where(unfinished).values(state=REMOVING))

    async def receive(self, pieces: AsyncIterable[bytes], size: int | None) -> int:
        """Import the archive that arrives in pieces, of `size` bytes if known, and return its new number.

        Raises RefusedError if it cannot be imported now, ArchiveError, FileWriteError if the disk fails,
        StoreError.
        """
        if self._busy.locked():
            raise RefusedError("Another archive is being imported. Wait for its end.")
        async with self._busy:
            self._check_room(COPIES * (size or 0))
            path = self._folder / (token_hex(8) + PART)
            try:
                await self._save(pieces, path)
                return await self._take(path)
            finally:
                await asyncio.to_thread(path.unlink, missing_ok=True)

    async def take(self, path: Path) -> int:
        """Import the archive in a file. Raises as `receive`."""
        async with self._busy:
            self._check_room(path.stat().st_size)
            return await self._take(path)

    def _check_room(self, size: int) -> None:
        free = shutil.disk_usage(self._data).free
        if free < size + SPARE_BYTES:
            raise FileWriteError(
                f"The disk that holds {self._data} has {free / 1e6:.0f} MB free; this needs "
                f"{(size + SPARE_BYTES) / 1e6:.0f} MB. Free some space, and try again."
            )

    async def _save(self, pieces: AsyncIterable[bytes], path: Path) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("wb") as file:
                waiting = bytearray()
                async for piece in pieces:
                    waiting += piece
                    if len(waiting) >= PIECE_BYTES:
                        await asyncio.to_thread(file.write, bytes(waiting))
                        waiting.clear()
                        self._check_room(file.tell())
                await asyncio.to_thread(file.write, bytes(waiting))
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, path)) from problem

    async def _take(self, path: Path) -> int:
        try:
            await ExportProcess(["examine", str(path)], lambda _: None).run()
        except ExportProcessError as problem:
            raise ArchiveError(f"The archive cannot be imported. {problem}") from problem
        with open_archive(path) as archive:
            self._refuse_known(archive)
            values = _session_values(archive)
            number = await self._store.write(lambda connection: insert_row(connection, SessionRow, values))
            try:
                await self._fill(number, archive)
            except BaseException:
                # The retention worker removes the rest.
                await asyncio.shield(self._change(number, {"state": REMOVING}))
                raise
        return number

    def _refuse_known(self, archive: Archive) -> None:
        identifier = archive.content.session.identifier
        with self._store.read() as database:
            row = database.exec(select(SessionRow).where(SessionRow.identifier == identifier)).first()
        if row is None:
            return
        if row.state == REMOVING:
            raise RefusedError("This session was here and is being removed. Try again in a few minutes.")
        binned = " It is in the bin; restore it there." if row.deleted is not None else ""
        raise RefusedError(f"This session is here already, as number {row.id}: “{row.name}”.{binned}")

    async def _fill(self, number: int, archive: Archive) -> None:
        content = archive.content
        session = {"session_id": number}
        small: list[tuple[type[SQLModel], list[dict[str, Any]]]] = [
            (SessionTag, [session | {"tag": tag} for tag in dict.fromkeys(content.tags)]),
            (BookmarkRow, [session | bookmark.model_dump() for bookmark in content.markers]),
            (Gap, [session | gap.model_dump() for gap in content.gaps]),
        ]
        for table, rows in small:
            for at in range(0, len(rows), ROWS_AT_ONCE):
                await self._store.execute(insert(table), rows[at : at + ROWS_AT_ONCE])
        batches = _batches(archive, number)
        samples = size = 0
        while batch := await asyncio.to_thread(next, batches, None):
            await self._store.execute(insert(Chunk), batch)
            samples += sum(row["count"] for row in batch)
            size += sum(len(row["data"]) for row in batch)
        done = {"state": content.session.state, "samples": samples, "bytes": size}
        await self._change(number, done)

    async def _change(self, number: int, values: dict[str, Any]) -> None:
        await self._store.execute(update(SessionRow).where(col(SessionRow.id) == number).values(values))


def _session_values(archive: Archive) -> dict[str, Any]:
    session = archive.content.session
    values = session.model_dump(exclude={"topics", "robot_state", "state"})
    return values | {
        "topics": json.dumps(archive.described_topics, ensure_ascii=False),
        "robot_state": json.dumps(session.robot_state, ensure_ascii=False),
        "state": IMPORTING,
        "origin": "import",
        "samples": 0,
        "bytes": 0,
        "kept": False,
    }


def _batches(archive: Archive, number: int) -> Iterator[list[dict[str, Any]]]:
    batch: list[dict[str, Any]] = []
    size = 0
    for chunk in chain.from_iterable(archive.chunks(topic) for topic in archive.topics):
        values = chunk._asdict()
        batch.append({**values, "count": values.pop("samples"), "session_id": number})
        size += len(chunk.data)
        if size >= BATCH_BYTES:
            yield batch
            batch, size = [], 0
    if batch:
        yield batch
