"""Numbers of rows that a restored database must not use again."""

import sqlite3
from contextlib import closing, suppress
from pathlib import Path

from server.platform.sqlite_file import open_database


def carry_numbers(replaced: Path, restored: Path) -> None:
    """Make a restored database of this version continue the numbers of the replaced one.

    That one may be damaged or missing. Raise sqlite3.DatabaseError where the restored one cannot be written.
    """
    with closing(sqlite3.connect(restored)) as fresh:
        counted = [
            name
            for name, text in fresh.execute("SELECT name, sql FROM sqlite_master WHERE type = 'table'")
            if "AUTOINCREMENT" in text
        ]
        last: dict[str, int] = {}
        # What a damaged database has given cannot be told.
        with suppress(sqlite3.DatabaseError), closing(open_database(replaced, "ro")) as old:
            last = {table: _last_number(old, table) for table in counted}
        for table, number in last.items():
            if number > _last_number(fresh, table):
                fresh.execute("DELETE FROM sqlite_sequence WHERE name = ?", (table,))
                fresh.execute("INSERT INTO sqlite_sequence (name, seq) VALUES (?, ?)", (table, number))
        fresh.commit()


def _last_number(database: sqlite3.Connection, table: str) -> int:
    """Return the greatest number that the table has or had; 0 where that is not known."""
    numbers = [0]
    for query in (f"SELECT max(id) FROM {table}", f"SELECT seq FROM sqlite_sequence WHERE name = '{table}'"):
        with suppress(sqlite3.OperationalError):  # an older version has no such table
            numbers += [row[0] or 0 for row in database.execute(query)]
    return max(numbers)
