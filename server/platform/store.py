"""The database: one writing connection in a thread of its own, and connections that only read.

A change survives a power cut once `write` has returned (docs/reference/durability.md).
"""

import asyncio
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import Connection, Delete, UpdateBase, insert
from sqlalchemy.exc import DBAPIError
from sqlmodel import Session, SQLModel

from server.platform.engine import DISK_FULL, DatabaseEngine, Space
from server.platform.errors import InsufficientStorageError, UnavailableError
from server.platform.postgresql import PostgreSQL
from server.platform.sqlite import SQLite

T = TypeVar("T")


class StoreError(UnavailableError):
    """The database does not work"""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        if text.startswith(DISK_FULL):
            self.status = InsufficientStorageError.status

    @property
    def detail(self) -> str:
        """The reason in a sentence."""
        return f"The database does not work: {self}."


class Reader:
    """Read access to a database that `schema.prepare` has upgraded; works beside a running server.

    `location` is a file of SQLite, or the URL of a PostgreSQL database.
    """

    def __init__(self, location: Path | str) -> None:
        self.location = location
        self._engine: DatabaseEngine = (
            SQLite(location) if isinstance(location, Path) else PostgreSQL(location)
        )
        self._reader = self._engine.reading()

    @contextmanager
    def read(self) -> Iterator[Session]:
        """Open a session for reading. Keep it short: during a long one the write-ahead log grows."""
        try:
            with Session(self._reader) as session:
                yield session
        except DBAPIError as problem:
            raise StoreError(self._engine.explain(problem)) from problem

    def measure(self) -> Space:
        """Return the room that the database takes. Raise StoreError."""
        with self.read() as database:
            return self._engine.measure(database.connection())

    def close(self) -> None:
        """Close the database. Call it once."""
        self._reader.dispose()


class Store(Reader):
    """Read and write access to the database; `failing` is the reason of the last write's failure.

    On a full disk it gives up its reserve for changes that free room. Raises StoreError where another
    program has the database open for writing.
    """

    def __init__(self, location: Path | str) -> None:
        super().__init__(location)
        try:
            self._engine.hold()
        except BlockingIOError as problem:
            raise StoreError(self._engine.held) from problem
        self.failing: str | None = None
        self._writer = self._engine.writing()
        self._thread = ThreadPoolExecutor(1, "writer")
        try:
            self._thread.submit(self._open).result()
        except StoreError:
            self._thread.shutdown()
            self._engine.release()
            raise

    async def write(self, change: Callable[[Connection], T], *, frees: bool = False) -> T:
        """Run `change` in one transaction in the writer's thread; committed when this returns.

        `frees` is a change that leads to free room. Raise StoreError where it could not be committed; then
        nothing of it is stored.
        """
        commit = self._commit_freeing if frees else self._commit
        return await asyncio.wrap_future(self._thread.submit(commit, change))

    async def execute(self, change: UpdateBase, rows: Sequence[Mapping[str, Any]] | None = None) -> int:
        """Run one statement in a transaction, for each of `rows` if given; return the rows changed."""
        return await self.write(
            lambda connection: connection.execute(change, rows).rowcount, frees=isinstance(change, Delete)
        )

    async def free_some(self, pages: int) -> int:
        """Return a few free pages of the database to the disk; return how many are left."""
        return await self.write(lambda connection: self._engine.free_some(connection, pages), frees=True)

    async def make_reserve(self) -> None:
        """Set room aside for deletions, where there is enough."""
        if self._engine.reserve is not None:
            await asyncio.wrap_future(self._thread.submit(self._engine.reserve.make))

    async def probe(self) -> None:
        """Test writing with a minimal change. Raise StoreError where it does not."""
        await self.write(self._engine.touch)

    def close(self) -> None:
        """Wait for pending writes, and close. Blocks; call it once."""
        self._thread.submit(self._connection.close).result()
        self._thread.shutdown()
        super().close()
        self._writer.dispose()
        self._engine.release()

    def _open(self) -> None:
        try:
            self._connection = self._writer.connect()
        except BlockingIOError as problem:
            raise StoreError(self._engine.held) from problem
        except DBAPIError as problem:
            raise StoreError(self._engine.explain(problem)) from problem

    def _commit_freeing(self, change: Callable[[Connection], T]) -> T:
        try:
            return self._commit(change)
        except StoreError:
            reserve = self._engine.reserve
            if not (self.failing or "").startswith(DISK_FULL) or reserve is None or not reserve.give_up():
                raise
        return self._commit(change)

    def _commit(self, change: Callable[[Connection], T]) -> T:
        try:
            with self._connection.begin():
                result = change(self._connection)
        except DBAPIError as problem:
            self.failing = self._engine.explain(problem)
            raise StoreError(self.failing) from problem
        except BlockingIOError as problem:
            # The connection was cut, and another lab has become the writer meanwhile.
            self.failing = self._engine.held
            raise StoreError(self.failing) from problem
        self.failing = None
        return result


def insert_row(connection: Connection, table: type[SQLModel], values: Mapping[str, Any]) -> int:
    """Insert a row, within a transaction; return its number."""
    key = connection.execute(insert(table).values(**values)).inserted_primary_key
    assert key is not None
    return int(key[0])


def insert_unless_there(connection: Connection, table: type[SQLModel]) -> Any:
    """Return an INSERT that can say what it does with rows that are there, in the database's dialect."""
    if connection.dialect.name == "postgresql":
        from sqlalchemy.dialects.postgresql import insert as insert_into
    else:
        from sqlalchemy.dialects.sqlite import insert as insert_into  # type: ignore[assignment]
    return insert_into(table)
