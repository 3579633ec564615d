"""A database file of SQLite: opened, and given its tables."""

import sqlite3
from pathlib import Path
from typing import Literal

from migrations import FOLDER

INCREMENTAL = 2
"""SQLite's auto_vacuum mode that returns free pages to the disk in small steps, on request."""
_NEW = FOLDER / "schema.sql"


def open_database(database: Path, mode: Literal["ro", "rw"]) -> sqlite3.Connection:
    """Open an existing database. Raise sqlite3.DatabaseError."""
    return sqlite3.connect(f"{database.absolute().as_uri()}?mode={mode}", uri=True)


def create_tables(connection: sqlite3.Connection) -> None:
    """Make the tables of a new database, all or none. Raise sqlite3.DatabaseError."""
    # The migrations would do the same in twenty times the time.
    tables = _NEW.read_text(encoding="utf-8")
    connection.execute(f"PRAGMA auto_vacuum = {INCREMENTAL}")
    connection.executescript(f"BEGIN IMMEDIATE;\n{tables}COMMIT;")
