"""Copies of a lab's archive in PostgreSQL as a file of SQLite, and back.

Backups of both databases are of one form. So each is examined, upgraded and moved alike, whatever the version
of PostgreSQL, and a lab goes from a file to PostgreSQL, or back, by a backup.
"""

import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any, cast

import psycopg
from sqlalchemy import Connection, Engine, Table, create_engine, delete, func, pool, select, text
from sqlalchemy.exc import DBAPIError
from sqlmodel import SQLModel

from migrations import HEAD
from server.platform import models as _models  # noqa: F401 - its tables
from server.platform.postgresql import CONNECT_SECONDS, WRITER, PostgreSQL
from server.platform.settings import SetupError
from server.platform.sqlite_file import create_tables, open_database

ROWS = 100
"""Rows at once in memory: a chunk of a film has up to a megabyte."""


def copy_archive(url: str, copy: sqlite3.Connection) -> None:
    """Fill an empty database with all rows of an archive, as they are at one moment.

    Raise SetupError where the archive cannot be read, or is of another version; sqlite3.DatabaseError.
    """
    create_tables(copy)
    engine = _connect(url, isolation_level="REPEATABLE READ")
    try:
        with engine.connect() as archive, archive.begin():
            _refuse_other_revision(archive, url)
            for table in SQLModel.metadata.sorted_tables:
                _copy_rows(archive, copy, table)
            for table in _numbered():
                number = _last_number(archive, table)
                copy.execute("DELETE FROM sqlite_sequence WHERE name = ?", (table.name,))
                copy.execute("INSERT INTO sqlite_sequence (name, seq) VALUES (?, ?)", (table.name, number))
        copy.commit()
    except DBAPIError as problem:
        raise SetupError(
            f"The archive {url} cannot be read: {PostgreSQL(url).explain(problem)}."
        ) from problem


def restore_archive(url: str, database: Path) -> None:
    """Put the rows of a database of this version into an archive without sessions, all or none.

    New rows get numbers beyond those of both. Raise SetupError where the archive has sessions, is in use, or
    does not take them; sqlite3.DatabaseError.
    """
    engine = _connect(url)
    try:
        with engine.begin() as archive, closing(open_database(database, "ro")) as source:
            _require_free(archive, url)
            for table in reversed(SQLModel.metadata.sorted_tables):
                archive.execute(delete(table))
            for table in SQLModel.metadata.sorted_tables:
                _restore_rows(archive, source, table)
            numbers = dict(source.execute("SELECT name, seq FROM sqlite_sequence"))
            for table in SQLModel.metadata.sorted_tables:
                _go_on_after(archive, table, int(numbers.get(table.name, 0)))
    except (DBAPIError, psycopg.Error) as problem:
        reason = (
            PostgreSQL(url).explain(problem)
            if isinstance(problem, DBAPIError)
            else " ".join(str(problem).split())
        )
        raise SetupError(f"Nothing was restored into the archive {url}: {reason}.") from problem


def _connect(url: str, **more: Any) -> Engine:
    arguments = {"connect_timeout": CONNECT_SECONDS, "application_name": "mucat"}
    return create_engine(url, poolclass=pool.NullPool, connect_args=arguments, **more)


def _refuse_other_revision(archive: Connection, url: str) -> None:
    revision = archive.exec_driver_sql("SELECT version_num FROM alembic_version").scalar_one()
    if revision != HEAD:
        raise SetupError(
            f"The archive {url} is of another version (its revision is {revision}, this version's is "
            f"{HEAD}). Start the lab once with this version, which upgrades it; or take the version that "
            "wrote it."
        )


def _require_free(archive: Connection, url: str) -> None:
    """Raise SetupError where a lab writes the archive, or where it has sessions."""
    if not archive.exec_driver_sql(f"SELECT pg_try_advisory_xact_lock({WRITER})").scalar_one():
        raise SetupError(f"A lab writes the archive {url}. End it first.")
    sessions = archive.exec_driver_sql("SELECT count(*) FROM session").scalar_one()
    if sessions:
        raise SetupError(
            f"The archive {url} has sessions ({sessions}), which a restore does not overwrite. Make an empty "
            "database (createdb), and name it as `database` under [lab] in robot.toml."
        )


def _copy_rows(archive: Connection, copy: sqlite3.Connection, table: Table) -> None:
    names, marks = _names(table), ", ".join("?" * len(table.columns))
    rows = archive.execute(select(*table.columns), execution_options={"yield_per": ROWS})
    for part in rows.partitions():
        copy.executemany(f'INSERT INTO "{table.name}" ({names}) VALUES ({marks})', map(tuple, part))
    _compare(archive, copy, table)


def _restore_rows(archive: Connection, source: sqlite3.Connection, table: Table) -> None:
    names = _names(table)
    driver = cast("psycopg.Connection", archive.connection.driver_connection)
    with driver.cursor() as cursor, cursor.copy(f'COPY "{table.name}" ({names}) FROM STDIN') as lines:
        for row in source.execute(f'SELECT {names} FROM "{table.name}"'):
            lines.write_row(row)
    _compare(archive, source, table)


def _compare(archive: Connection, database: sqlite3.Connection, table: Table) -> None:
    """Raise sqlite3.DatabaseError where not all rows of a table are on both sides."""
    here = archive.execute(select(func.count()).select_from(table)).scalar_one()
    (there,) = database.execute(f'SELECT count(*) FROM "{table.name}"').fetchone()
    if here != there:
        raise sqlite3.DatabaseError(f"{there} of {here} rows of {table.name} were copied")


def _go_on_after(archive: Connection, table: Table, number: int) -> None:
    """Have new rows of a table get numbers beyond this one, its rows' and those given before."""
    sequence = _sequence_of(archive, table)
    if sequence is None:
        return
    greatest = archive.execute(select(func.max(table.c.id))).scalar_one() or 0
    last = max(number, greatest, _last_number(archive, table))
    if last:
        archive.execute(text("SELECT setval(:name, :last)"), {"name": sequence, "last": last})


def _last_number(archive: Connection, table: Table) -> int:
    """Return the last number that a table has given; 0 before the first."""
    sequence = _sequence_of(archive, table)
    value = archive.exec_driver_sql(
        f"SELECT CASE WHEN is_called THEN last_value ELSE 0 END FROM {sequence}"
    ).scalar_one()
    return int(value)


def _sequence_of(archive: Connection, table: Table) -> str | None:
    """Return the sequence of a table's numbers; None where its rows have none of their own."""
    if "id" not in table.columns:
        return None
    question = text("SELECT pg_get_serial_sequence(:name, 'id')")
    sequence: str | None = archive.execute(question, {"name": table.name}).scalar_one()
    return sequence


def _numbered() -> list[Table]:
    """Return the tables that never give a number again."""
    return [table for table in SQLModel.metadata.sorted_tables if table.kwargs.get("sqlite_autoincrement")]


def _names(table: Table) -> str:
    return ", ".join(f'"{column.name}"' for column in table.columns)
