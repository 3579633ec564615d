"""Brings the database to this version's tables before anything else opens it."""

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from migrations import HEAD
from server.settings import DataFolder, SetupError

INCREMENTAL = 2
"""SQLite's auto_vacuum in which pages that became free are given back a few at a time, when asked for."""


def prepare(folder: DataFolder) -> None:
    """Create or upgrade the database; an older one is copied to `backups` first.

    Raises SetupError where the database is of a newer version, damaged, or cannot be written.
    """
    try:
        revision = read_revision(folder.database)
        if revision == HEAD:
            return
        if revision is not None:
            _refuse_unknown(revision, folder.database)
            _back_up(folder, revision)
            _make_shrinkable(folder.database)
        _upgrade(folder.database)
    except sqlite3.DatabaseError as problem:
        raise SetupError(
            f"The database {folder.database} cannot be used: {problem}. "
            "Move it away to start with an empty one, or put back a copy."
        ) from problem


def read_revision(database: Path) -> str | None:
    """The revision that a database is at; None where there is none yet. Raises sqlite3.DatabaseError."""
    if not database.exists():
        return None
    with closing(sqlite3.connect(database)) as connection:
        tables = {
            name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        }
        if "alembic_version" not in tables:
            if tables:
                raise sqlite3.DatabaseError("it holds tables of another program")
            return None
        row = connection.execute("SELECT version_num FROM alembic_version").fetchone()
    return None if row is None else str(row[0])


def _refuse_unknown(revision: str, database: Path) -> None:
    from alembic.script import ScriptDirectory

    known = {script.revision for script in ScriptDirectory(_scripts()).walk_revisions()}
    if revision not in known:
        raise SetupError(
            f"The database {database} was written by a newer version (its revision is {revision}, this "
            f"version's is {HEAD}). Install that version, or choose another data folder with --data."
        )


def _back_up(folder: DataFolder, revision: str) -> None:
    folder.backups.mkdir(exist_ok=True)
    moment = time.strftime("%Y-%m-%d_%H-%M-%S", time.gmtime())
    copy = folder.backups / f"mucat-{revision}-{moment}.db"
    unfinished = copy.with_suffix(".part")
    with closing(sqlite3.connect(folder.database)) as source, closing(sqlite3.connect(unfinished)) as target:
        source.backup(target)
    _sync(unfinished)
    unfinished.rename(copy)
    _sync(folder.backups)


def _make_shrinkable(database: Path) -> None:
    """Have room given back of which an older version only made use again; it takes a copy of everything."""
    with closing(sqlite3.connect(database, isolation_level=None)) as connection:
        (kind,) = connection.execute("PRAGMA auto_vacuum").fetchone()
        if kind != INCREMENTAL:
            connection.execute(f"PRAGMA auto_vacuum = {INCREMENTAL}")
            connection.execute("VACUUM")


def _upgrade(database: Path) -> None:
    # Alembic is loaded only where there is something to do: it costs a Raspberry Pi time and memory.
    from alembic import command
    from alembic.config import Config
    from sqlalchemy import create_engine, pool

    engine = create_engine(f"sqlite:///{database}", poolclass=pool.NullPool)
    config = Config()
    config.set_main_option("script_location", str(_scripts()))
    config.set_main_option("path_separator", "os")
    with _driver_errors(), engine.connect() as connection:
        # Of a database that has tables already this changes nothing.
        connection.exec_driver_sql(f"PRAGMA auto_vacuum = {INCREMENTAL}")
        config.attributes["connection"] = connection
        command.upgrade(config, "head")
        connection.commit()


@contextmanager
def _driver_errors() -> Iterator[None]:
    from sqlalchemy.exc import DBAPIError

    try:
        yield
    except DBAPIError as problem:
        raise sqlite3.DatabaseError(str(problem.orig)) from problem


def _scripts() -> Path:
    return Path(__file__).parent.parent / "migrations"


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
