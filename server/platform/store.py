"""The database: one writing connection in a thread of its own, and connections that only read.

SQLite before 3.51.3 can corrupt a write-ahead log that two connections write, so there is one writer: it
holds a lock on the database's folder. A change survives a power cut once `write` has returned
(docs/reference/durability.md).
"""

import asyncio
import fcntl
import os
import sqlite3
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import Connection, Delete, Engine, UpdateBase, create_engine, event, insert, pool
from sqlalchemy.exc import DBAPIError
from sqlmodel import Session, SQLModel

from server.platform.database_copies import DAMAGED_REMEDY
from server.platform.disk_reserve import DiskReserve
from server.platform.errors import InsufficientStorageError, UnavailableError
from server.platform.searching import fold
from server.platform.settings import RESERVE

T = TypeVar("T")
PAGE_CACHE_KIB = 1024
FULL = "the disk is full: free some space on the computer that holds the data folder"


class StoreError(UnavailableError):
    """The database does not work"""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        if text == FULL:
            self.status = InsufficientStorageError.status

    @property
    def detail(self) -> str:
        """The reason in a sentence."""
        return f"The database does not work: {self}."


class Reader:
    """Read access to a database that `schema.prepare` has upgraded; works beside a running server."""

    def __init__(self, database: Path) -> None:
        self._reader = _engine(database, "mode=ro", pool.QueuePool)

    @contextmanager
    def read(self) -> Iterator[Session]:
        """Open a session for reading. Keep it short: during a long one the write-ahead log grows."""
        try:
            with Session(self._reader) as session:
                yield session
        except DBAPIError as problem:
            raise StoreError(_explain(problem)) from problem

    def close(self) -> None:
        """Close the database. Call it once."""
        self._reader.dispose()


class Store(Reader):
    """Read and write access to the database; `failing` is the reason of the last write's failure.

    On a full disk it gives up its `reserve` for changes that free room. Raises StoreError where another
    program has the database open for writing.
    """

    def __init__(self, database: Path) -> None:
        self._folder = _hold(database.parent)
        super().__init__(database)
        self.failing: str | None = None
        self.reserve = DiskReserve(database.with_name(RESERVE))
        # With psow=0 no two commits share a sector: a power cut that damages the sector being written damages
        # no earlier commit.
        self._writer = _engine(database, "psow=0", pool.StaticPool)
        event.listen(self._writer, "connect", _make_durable)
        # The driver begins a transaction only before a row changes: each PRAGMA would be one of its own.
        event.listen(self._writer, "begin", lambda begun: begun.exec_driver_sql("BEGIN IMMEDIATE"))
        self._thread = ThreadPoolExecutor(1, "writer")
        self._thread.submit(self._open).result()

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

    async def make_reserve(self) -> None:
        """Set room aside for deletions, where there is enough."""
        await asyncio.wrap_future(self._thread.submit(self.reserve.make))

    async def probe(self) -> None:
        """Test writing with a minimal change. Raise StoreError where it does not."""
        await self.write(_touch)

    def close(self) -> None:
        """Wait for pending writes, and close. Blocks; call it once."""
        self._thread.submit(self._connection.close).result()
        self._thread.shutdown()
        super().close()
        self._writer.dispose()
        os.close(self._folder)

    def _open(self) -> None:
        self._connection = self._writer.connect()

    def _commit_freeing(self, change: Callable[[Connection], T]) -> T:
        try:
            return self._commit(change)
        except StoreError:
            if self.failing != FULL or not self.reserve.give_up():
                raise
        return self._commit(change)

    def _commit(self, change: Callable[[Connection], T]) -> T:
        try:
            with self._connection.begin():
                result = change(self._connection)
        except DBAPIError as problem:
            self.failing = _explain(problem)
            raise StoreError(self.failing) from problem
        self.failing = None
        return result


def insert_row(connection: Connection, table: type[SQLModel], values: Mapping[str, Any]) -> int:
    """Insert a row, within a transaction; return its number."""
    key = connection.execute(insert(table).values(**values)).inserted_primary_key
    assert key is not None
    return int(key[0])


def _touch(connection: Connection) -> None:
    (version,) = connection.exec_driver_sql("PRAGMA user_version").one()
    connection.exec_driver_sql(f"PRAGMA user_version = {(version + 1) % 1000}")


def _hold(folder: Path) -> int:
    """Lock the folder for one writer. A folder's lock does not affect SQLite's locks on its files."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as problem:
        os.close(handle)
        raise StoreError(f"another program writes the database in {folder}: end it first") from problem
    return handle


def _engine(database: Path, options: str, pool_class: type[pool.Pool]) -> Engine:
    uri = f"{database.absolute().as_uri()}?{options}"

    def connect() -> sqlite3.Connection:
        return sqlite3.connect(uri, uri=True, check_same_thread=False)

    engine = create_engine("sqlite://", poolclass=pool_class, creator=connect)
    event.listen(engine, "connect", _configure)
    return engine


def _configure(connection: sqlite3.Connection, _record: object) -> None:
    # SQLite's own comparisons ignore case only for ASCII letters.
    connection.create_function("casefold", 1, str.casefold, deterministic=True)
    connection.create_function("fold", 1, fold, deterministic=True)
    connection.execute("PRAGMA foreign_keys = ON")
    connection.execute("PRAGMA busy_timeout = 2000")
    connection.execute(f"PRAGMA cache_size = -{PAGE_CACHE_KIB}")


def _make_durable(connection: sqlite3.Connection, _record: object) -> None:
    connection.isolation_level = None
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")


def _explain(problem: DBAPIError) -> str:
    message = str(problem.orig)
    if "disk is full" in message:
        return FULL
    if "disk I/O error" in message:
        return "the disk does not take or give data (input/output error): check the SD card or disk"
    if "readonly" in message:
        return "the data folder cannot be written: check its permissions, and whether the disk is read-only"
    if "malformed" in message or "not a database" in message:
        return f"the database is damaged: {message}. {DAMAGED_REMEDY}"
    return f"the database refuses: {message}"
