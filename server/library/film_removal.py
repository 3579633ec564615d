"""The removal of films to make room: their sessions keep every other sample, and say that the film went."""

import asyncio

from sqlalchemy import Connection, delete, insert, update
from sqlmodel import col, func, select

from robot_runtime.contract.topics import FILM
from server.platform.models import Chunk, Gap, SessionRow
from server.platform.store import Store

CHUNKS_AT_ONCE = 32
PAUSE = 0.02
"""s between two such steps, which leave the disk to the recorder."""


class FilmRemoval:
    """Finds and removes the films of sessions. All methods raise StoreError."""

    def __init__(self, store: Store) -> None:
        self._store = store

    async def filmed(self) -> set[int]:
        """Return the numbers of all sessions that have a film."""
        film = select(Chunk.id).where(Chunk.session_id == SessionRow.id, Chunk.topic == FILM.name)
        query = select(SessionRow.id).where(film.exists())

        def read() -> set[int]:
            with self._store.read() as database:
                return {number for number in database.exec(query) if number is not None}

        return await asyncio.to_thread(read)

    async def measure(self, session: int) -> int:
        """Return the bytes of a session's film."""
        size = select(func.coalesce(func.sum(func.length(Chunk.data)), 0))
        size = size.where(Chunk.session_id == session, Chunk.topic == FILM.name)

        def read() -> int:
            with self._store.read() as database:
                return int(database.exec(size).one())

        return await asyncio.to_thread(read)

    async def remove(self, session: int) -> None:
        """Remove a session's film in small transactions, and note that it went."""
        while await self._store.write(lambda connection: _remove_some(connection, session), frees=True):
            await asyncio.sleep(PAUSE)


def _remove_some(connection: Connection, session: int) -> int:
    some = select(Chunk.id, func.length(Chunk.data), Chunk.count, Chunk.first_time)
    some = some.where(Chunk.session_id == session, Chunk.topic == FILM.name).order_by(col(Chunk.number))
    rows = connection.execute(some.limit(CHUNKS_AT_ONCE)).all()
    if not rows:
        return 0
    connection.execute(delete(Chunk).where(col(Chunk.id).in_([row[0] for row in rows])))
    size, pictures = (sum(row[column] for row in rows) for column in (1, 2))
    connection.execute(
        update(SessionRow)
        .where(col(SessionRow.id) == session)
        .values(bytes=col(SessionRow.bytes) - size, samples=col(SessionRow.samples) - pictures)
    )
    noted = update(Gap).where(col(Gap.session_id) == session, col(Gap.kind) == "removed")
    if connection.execute(noted.values(missed=col(Gap.missed) + pictures)).rowcount == 0:
        gap = {"topic": FILM.name, "kind": "removed", "time": rows[0][3], "missed": pictures}
        connection.execute(insert(Gap).values(session_id=session, **gap))
    return len(rows)
