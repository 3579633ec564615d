"""SQLite in the data folder: the database of a robot, and of a small lab.

SQLite before 3.51.3 can corrupt a write-ahead log that two connections write, so there is one writer: it
holds a lock on the database's folder.
"""

import fcntl
import os
import sqlite3
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine, event, pool
from sqlalchemy.exc import DBAPIError

from server.platform.database_copies import DAMAGED_REMEDY
from server.platform.disk_reserve import DiskReserve
from server.platform.engine import DISK_FULL, DatabaseEngine, Space
from server.platform.searching import fold
from server.platform.settings import RESERVE
from server.platform.sqlite_file import INCREMENTAL

PAGE_CACHE_KIB = 1024
FULL = f"{DISK_FULL}: free some space on the computer that holds the data folder"


class SQLite(DatabaseEngine):
    """A file of SQLite; with it the reserve beside it."""

    def __init__(self, database: Path) -> None:
        self._database = database
        self._folder = -1
        self.held = f"another program writes the database in {database.parent}: end it first"
        self.reserve = DiskReserve(database.with_name(RESERVE))

    def hold(self) -> None:
        """Lock the folder. Its lock does not affect SQLite's locks on its files."""
        folder = os.open(self._database.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(folder)
            raise
        self._folder = folder

    def release(self) -> None:
        """Unlock the folder."""
        os.close(self._folder)

    def reading(self) -> Engine:
        """Return connections that only read."""
        return connect_to(self._database, "mode=ro", pool.QueuePool)

    def writing(self) -> Engine:
        """Return the one connection that writes."""
        # With psow=0 no two commits share a sector: a power cut that damages the sector being written damages
        # no earlier commit.
        writer = connect_to(self._database, "psow=0", pool.StaticPool)
        event.listen(writer, "connect", make_durable)
        # The driver begins a transaction only before a row changes: each PRAGMA would be one of its own.
        event.listen(writer, "begin", lambda begun: begun.exec_driver_sql("BEGIN IMMEDIATE"))
        return writer

    def explain(self, problem: DBAPIError) -> str:
        """Return the reason of a failure, for a person."""
        message = str(problem.orig)
        if "disk is full" in message:
            return FULL
        if "disk I/O error" in message:
            return "the disk does not take or give data (input/output error): check the SD card or disk"
        if "readonly" in message:
            return (
                "the data folder cannot be written: check its permissions, and whether the disk is read-only"
            )
        if "malformed" in message or "not a database" in message:
            return f"the database is damaged: {message}. {DAMAGED_REMEDY}"
        return f"the database refuses: {message}"

    def touch(self, connection: Connection) -> None:
        """Count up the user's version, which means nothing."""
        (version,) = connection.exec_driver_sql("PRAGMA user_version").one()
        connection.exec_driver_sql(f"PRAGMA user_version = {(version + 1) % 1000}")

    def measure(self, connection: Connection) -> Space:
        """Return the room of its files, and of its free pages."""
        pages = connection.exec_driver_sql("PRAGMA freelist_count").scalar_one()
        size = connection.exec_driver_sql("PRAGMA page_size").scalar_one()
        files = (Path(f"{self._database}{end}") for end in ("", "-wal", "-shm"))
        return Space(sum(_bytes(file) for file in files), int(pages * size))

    def free_some(self, connection: Connection, pages: int) -> int:
        """Return a few free pages to the disk; return how many are left, 0 where it does not shrink."""
        if connection.exec_driver_sql("PRAGMA auto_vacuum").scalar_one() != INCREMENTAL:
            return 0
        # The driver runs one step of such a statement only, and each step frees one page.
        for _ in range(pages):
            connection.exec_driver_sql("PRAGMA incremental_vacuum(1)")
        left: int = connection.exec_driver_sql("PRAGMA freelist_count").scalar_one()
        return left


def connect_to(database: Path, options: str, pool_class: type[pool.Pool]) -> Engine:
    """Return connections to the file, with these options of its URI."""
    uri = f"{database.absolute().as_uri()}?{options}"

    def connect() -> sqlite3.Connection:
        return sqlite3.connect(uri, uri=True, check_same_thread=False)

    engine = create_engine("sqlite://", poolclass=pool_class, creator=connect)
    event.listen(engine, "connect", _configure)
    return engine


def make_durable(connection: sqlite3.Connection, _record: object) -> None:
    """Have a commit survive a power cut once it has returned."""
    connection.isolation_level = None
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")


def _configure(connection: sqlite3.Connection, _record: object) -> None:
    # SQLite's own comparisons ignore case only for ASCII letters.
    connection.create_function("casefold", 1, str.casefold, deterministic=True)
    connection.create_function("fold", 1, fold, deterministic=True)
    connection.execute("PRAGMA foreign_keys = ON")
    connection.execute("PRAGMA busy_timeout = 2000")
    connection.execute(f"PRAGMA cache_size = -{PAGE_CACHE_KIB}")


def _bytes(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
