"""The database's schema: creation, and upgrade from older versions."""

import errno
import sqlite3
import tempfile
from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Literal

from migrations import HEAD, known_revisions, make_config
from server.platform.database_copies import DAMAGED_REMEDY, copy_database, new_copy_path, thin_out
from server.platform.settings import DataFolder, SetupError
from server.platform.sqlite_file import INCREMENTAL, create_tables, open_database

_REVISION = f"INSERT INTO alembic_version VALUES ('{HEAD}');\n"


def prepare(folder: DataFolder) -> None:
    """Create or upgrade the database; an older file is copied to `backups` first.

    Raise SetupError where the database is of a newer version, damaged, or cannot be written.
    """
    if isinstance(location := folder.database_location, str):
        # The models, which only an archive needs here, are slow to load.
        from server.platform.postgresql_schema import prepare_archive

        prepare_archive(location)
        return
    try:
        # Opened for writing, which rolls back the upgrade of a killed server.
        revision = read_revision(folder.database, "rw")
        if revision == HEAD:
            return
        if revision is None:
            _create(folder.database)
            return
        refuse_unknown(revision, folder.database, folder)
        copy = new_copy_path(folder, "before", revision)
        copy_database(folder.database, copy)
        thin_out(folder, "before", copy)
        upgrade(folder.database)
    except (sqlite3.DatabaseError, OSError) as problem:
        raise SetupError(
            f"The database {folder.database} cannot be used: {explain(problem, folder.path)}"
        ) from problem


def upgrade(database: Path) -> None:
    """Upgrade the tables of a database. Raise sqlite3.DatabaseError, OSError."""
    _make_shrinkable(database)
    _upgrade(database)


def write_schema() -> str:
    """Return the SQL text that makes a database as all migrations together make it."""
    with tempfile.TemporaryDirectory() as folder:
        database = Path(folder) / "new.db"
        _upgrade(database)
        with closing(sqlite3.connect(database)) as connection:
            # Alembic makes the indexes of a table in any order.
            made = connection.execute(
                "SELECT sql FROM sqlite_master WHERE name NOT LIKE 'sqlite_%' ORDER BY type = 'index', name"
            ).fetchall()
    tables = "".join(f"{text};\n" for (text,) in made)
    return f"-- Written by `make generate` from the migrations. Do not edit.\n{tables}{_REVISION}"


def explain(problem: sqlite3.DatabaseError | OSError, folder: Path) -> str:
    """Return a sentence for a person with the cause and the remedy."""
    message = str(problem)
    if "disk is full" in message or (isinstance(problem, OSError) and problem.errno == errno.ENOSPC):
        return f"the disk that holds {folder} is full. Free some space, and try again."
    if isinstance(problem, OSError) or "readonly" in message or "unable to open" in message:
        return f"{message}. Check the permissions of {folder}, and whether its disk is read-only."
    return f"{message}. {DAMAGED_REMEDY}."


def read_revision(database: Path, mode: Literal["ro", "rw"] = "ro") -> str | None:
    """Return the schema revision of a database; None where there is none yet. Raise sqlite3.DatabaseError."""
    if not database.exists():
        return None
    with closing(open_database(database, mode)) as connection:
        tables = {
            name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        }
        if "alembic_version" not in tables:
            if tables:
                raise sqlite3.DatabaseError("it holds tables of another program")
            return None
        row = connection.execute("SELECT version_num FROM alembic_version").fetchone()
    return None if row is None else str(row[0])


def refuse_unknown(revision: str, database: Path, folder: DataFolder | None = None) -> None:
    """Raise SetupError where this version does not know the revision.

    It names the backup in `folder` that fits this version.
    """
    # For this one Alembic need not be loaded, which would take most of a restart.
    if revision == HEAD:
        return
    known = known_revisions()
    if revision in known:
        return
    fitting = None if folder is None else find_copy(folder, known)
    remedy = (
        "Install that version, or choose another data folder with --data."
        if fitting is None
        else "Install that version. Or go back to the newest backup that fits this one, without what was "
        f"recorded since: `mucat restore {fitting}`."
    )
    raise SetupError(
        f"The database {database} was written by a newer version (its revision is {revision}, this "
        f"version's is {HEAD}). {remedy}"
    )


def find_copy(folder: DataFolder, known: Collection[str]) -> Path | None:
    """Return the newest copy in the folder that has one of these revisions."""
    for copy in sorted(folder.backups.glob("mucat-*.db"), key=lambda path: path.stem[-19:], reverse=True):
        try:
            if read_revision(copy) in known:
                return copy
        except sqlite3.DatabaseError:
            continue
    return None


def _make_shrinkable(database: Path) -> None:
    """Switch an older database to returning free pages to the disk; SQLite copies it whole for that."""
    with closing(sqlite3.connect(database, isolation_level=None)) as connection:
        (kind,) = connection.execute("PRAGMA auto_vacuum").fetchone()
        if kind != INCREMENTAL:
            connection.execute(f"PRAGMA auto_vacuum = {INCREMENTAL}")
            connection.execute("VACUUM")


def _create(database: Path) -> None:
    with closing(sqlite3.connect(database, isolation_level=None)) as connection:
        connection.execute("PRAGMA synchronous = FULL")
        create_tables(connection)


def _upgrade(database: Path) -> None:
    # Alembic is loaded only where there is something to do: it costs a Raspberry Pi time and memory.
    from alembic import command
    from sqlalchemy import create_engine, event, pool

    def connect() -> sqlite3.Connection:
        connection = sqlite3.connect(database, isolation_level=None)
        # Without effect on a database that already has tables.
        connection.execute(f"PRAGMA auto_vacuum = {INCREMENTAL}")
        connection.execute("PRAGMA synchronous = FULL")
        return connection

    engine = create_engine("sqlite://", poolclass=pool.NullPool, creator=connect)
    # The driver begins no transaction for changes of tables: a failed upgrade would stay half done.
    event.listen(engine, "begin", lambda begun: begun.exec_driver_sql("BEGIN IMMEDIATE"))
    config = make_config()
    with _driver_errors(), engine.connect() as connection:
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
